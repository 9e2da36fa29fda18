//! Islands: bodies and balls that can touch each other, stepped together and independent of all others.
//!
//! ```
//! use drape_solver::glam::Vec3;
//! use drape_solver::{Ball, BallMaterial, BodySettings, ClothBuilder, Edge, Environment, Island, step};
//!
//! // A curtain with a ball on its way into it.
//! let curtain = ClothBuilder::new(2.0, 2.0, 24, 24).placed(Vec3::new(-1.0, 1.0, 0.0), Vec3::X, Vec3::NEG_Y);
//! let mut island = Island::of_body(curtain.pin_edge(Edge::Top).build(BodySettings::default())?);
//! island.balls.push(Ball::new(BallMaterial::default(), Vec3::Z * 0.5, Vec3::Z * -10.0)?);
//! let mut touches = 0;
//! for _ in 0..15 {
//!     step(&mut island, &Environment::default())?;
//!     touches += island.touches.len();
//! }
//! assert!(touches > 0 && island.balls[0].velocity().z > -9.0);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! Design: `docs/design/rest_and_islands.md`.

use crate::contact::ball_cloth;
use crate::contact::ball_cloth_query::BallClothContact;
use crate::contact::body_contacts::BodyContacts;
use crate::contact::event::{Contact, Other, Party, Touch, pair_without};
use crate::contact::island_contacts::IslandContacts;
use crate::contact::reaction::Reactions;
use crate::contact::report::ContactReport;
use crate::contact::surface::counts::SelfContactCounts;
use crate::motion::environment::Environment;
use crate::simd::isa::Isa;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::obstacle_motion::{MovedObstacle, Reaction};
use crate::state::substep::Substep;
use crate::substep::order::Order;
use crate::substep::plan::BodyPlan;

/// Bodies and balls that are stepped together.
#[derive(Clone, Debug, Default)]
pub struct Island {
    /// Cloths, ropes and rigs.
    pub bodies: Vec<Body>,
    /// Cannon balls.
    pub balls: Vec<Ball>,
    /// Touches of balls in the last step.
    pub touches: Vec<Touch>,
    /// Contacts of the last step that a body, ball or obstacle [reports](Body::reports_contacts): one for each pair,
    /// bodies first, by index.
    pub contacts: Vec<Contact>,
    /// Reactions of the last step on obstacles that [ask](crate::Obstacle::reporting_reaction) for them, by index.
    pub reactions: Vec<Reaction>,
    /// Places and motions after the last step of obstacles with [rigid bodies](crate::Obstacle::with_rigid_body) that
    /// something was near, by index.
    pub moved: Vec<MovedObstacle>,
    /// The instruction set to run on; the bits do not depend on it.
    pub isa: Isa,
    /// Scratch of the step.
    pub context: IslandContext,
}

/// Scratch of an island's step, kept so that a step allocates nothing once warm.
#[derive(Clone, Debug, Default)]
pub struct IslandContext {
    /// Substeps of this step.
    pub(crate) substeps: u32,
    /// Iterations that the last substep took.
    pub(crate) iterations_taken: u32,
    /// The substep that runs now, from 0.
    pub(crate) substep_index: u32,
    /// Length of a substep in seconds.
    pub(crate) substep: f32,
    /// The order of a substep.
    pub(crate) order: Order,
    /// The plan of each body's substep, by the body's index.
    pub(crate) plans: Vec<BodyPlan>,
    pub(crate) contacts: IslandContacts,
    pub(crate) report: ContactReport,
    pub(crate) reactions: Reactions,
}

impl IslandContext {
    /// The substep that runs now.
    pub(crate) fn now<'a>(&self, isa: Isa, environment: &'a Environment) -> Substep<'a> {
        Substep {
            obstacles: &environment.obstacles,
            index: self.substep_index,
            count: self.substeps,
            duration: self.substep,
            isa,
        }
    }
}

/// Scratch of one body's step: its contacts with obstacles, the plan of its substep, and the memory of its line solves.
/// A host that regroups bodies from step to step keeps it beside the body, so that a warm step allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct BodyScratch {
    contacts: BodyContacts,
    plan: BodyPlan,
}

impl BodyScratch {
    /// Particles that obstacles pushed out in the last substep: the particle's index, the unit normal of the
    /// surface in the world, and the depth in metres, summed over the projections of the substep.
    pub fn contacts(&self) -> impl Iterator<Item = (usize, glam::Vec3, f32)> + '_ {
        self.contacts.obstacles.pushed_particles()
    }
}

impl Island {
    /// An island of one body.
    pub fn of_body(body: Body) -> Self {
        Self { bodies: vec![body], ..Self::default() }
    }

    /// An island of one ball.
    pub fn of_ball(ball: Ball) -> Self {
        Self { balls: vec![ball], ..Self::default() }
    }

    /// Adds a body with the scratch that it kept from an earlier island.
    pub fn push_body(&mut self, body: Body, scratch: BodyScratch) {
        self.fit_scratch();
        self.bodies.push(body);
        self.context.contacts.bodies.push(scratch.contacts);
        self.context.plans.push(scratch.plan);
    }

    /// Takes all bodies out with their scratch, in order.
    pub fn drain_bodies(&mut self) -> impl Iterator<Item = (Body, BodyScratch)> + '_ {
        self.fit_scratch();
        let contacts = self.context.contacts.bodies.drain(..);
        let scratch = contacts.zip(self.context.plans.drain(..));
        let scratch = scratch.map(|(contacts, plan)| BodyScratch { contacts, plan });
        self.bodies.drain(..).zip(scratch)
    }

    /// Removes the body at `index` with its scratch; the bodies behind it move up.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn remove_body(&mut self, index: usize) -> (Body, BodyScratch) {
        self.fit_scratch();
        let contacts = self.context.contacts.bodies.remove(index);
        let plan = self.context.plans.remove(index);
        (self.bodies.remove(index), BodyScratch { contacts, plan })
    }

    /// Gives each body scratch of its own.
    pub(crate) fn fit_scratch(&mut self) {
        let count = self.bodies.len();
        self.context.contacts.bodies.resize_with(count, BodyContacts::default);
        self.context.plans.resize_with(count, BodyPlan::default);
    }

    /// Particles of the body at `index` that obstacles pushed out in the last substep: the particle's index, the unit
    /// normal of the surface in the world, and the depth in metres, summed over the projections of the substep.
    pub fn body_contacts(&self, index: usize) -> impl Iterator<Item = (usize, glam::Vec3, f32)> + '_ {
        let contacts = self.context.contacts.bodies.get(index).into_iter();
        contacts.flat_map(|contacts| contacts.obstacles.pushed_particles())
    }

    /// Memory of the body at `index` in bytes: its state, the scratch of its step, its sticks and tethers. Lists of
    /// contacts do not count, nor do faces, which only the wind and contacts with balls read.
    pub fn body_bytes(&self, index: usize) -> usize {
        self.bodies[index].bytes() + self.context.plans.get(index).map_or(0, |plan| plan.lines.bytes())
    }

    /// Removes everything and keeps the memory.
    pub fn clear(&mut self) {
        self.bodies.clear();
        self.balls.clear();
        self.touches.clear();
        self.contacts.clear();
        self.reactions.clear();
        self.moved.clear();
    }

    /// Takes the body at `index` out in the middle of a step, and leaves an empty body that touches nothing. The other
    /// bodies keep their indices.
    pub fn vacate_body(&mut self, index: usize) {
        self.fit_scratch();
        self.bodies[index] = Body::default();
        self.context.contacts.bodies[index] = BodyContacts::default();
        self.context.plans[index] = BodyPlan::default();
        self.context.contacts.ball_cloth.forget(index);
        self.context.contacts.surfaces.clear();
        self.context.report.vacate(index);
    }

    /// Drops the touches of a body or ball that has been taken out of its list, and counts down the indices behind it.
    pub fn forget(&mut self, gone: Other) {
        self.context.report.forget(gone);
        self.touches.retain_mut(|touch| {
            let left = pair_without((Party::Ball(touch.ball), touch.other), gone);
            if let Some((Party::Ball(ball), other)) = left {
                (touch.ball, touch.other) = (ball, other);
            }
            left.is_some()
        });
    }

    /// The greatest number of iterations of a body.
    pub(crate) fn iterations(&self) -> u32 {
        self.bodies.iter().map(|body| body.settings.iterations).max().unwrap_or(1)
    }

    /// The number of iterations of the last substep: fewer than asked for if a body's
    /// [tolerance](crate::BodySettings::tolerance) let it stop early.
    pub fn iterations_taken(&self) -> u32 {
        self.context.iterations_taken
    }

    /// The work of [self-contact](crate::BodySettings::self_contact) in the last step.
    pub fn self_contact_counts(&self) -> SelfContactCounts {
        self.context.contacts.surfaces.counts()
    }

    /// The number of substeps of the step that was [begun](crate::step::begin).
    pub fn substeps(&self) -> u32 {
        self.context.substeps
    }

    /// Adds the overlaps of balls with cloth in the middle of a step, right after
    /// [`integrate`](crate::step::integrate), to `found`: those on which the first projection of contacts would act if
    /// nothing else was pushed meanwhile. Only candidates of the last
    /// [`detect_collisions`](crate::step::detect_collisions) are tested. Returns the number of faces whose nearest
    /// point was computed.
    pub fn ball_cloth_contacts(&mut self, found: &mut Vec<BallClothContact>) -> usize {
        let contacts = &mut self.context.contacts.ball_cloth;
        ball_cloth::find_all(contacts, &self.bodies, &self.balls, self.isa, |contact| found.push(contact))
    }
}
