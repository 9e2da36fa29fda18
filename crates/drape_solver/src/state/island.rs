//! Islands: bodies and balls that can touch each other, stepped together and independent of all others.

use glam::Vec3;

use crate::broad_phase::ball_search::BallSearch;
use crate::contact::ball_ball::BallPair;
use crate::contact::ball_cloth::BallCloth;
use crate::contact::ball_obstacle::BallObstacle;
use crate::contact::cloth_cloth::SelfContacts;
use crate::contact::dynamic_obstacle::{MovedObstacle, Mover};
use crate::contact::event::{Contact, Other, Party, Touch, pair_without};
use crate::contact::impact_zone::ImpactZones;
use crate::contact::reaction::{Reaction, Reactions};
use crate::contact::report::ContactReport;
use crate::motion::wind::{Wind, WindZone};
use crate::simd::isa::Isa;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::obstacles::Obstacles;

/// What is the same for all islands in one step.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Length of the step in seconds.
    pub dt: f32,
    /// Acceleration of gravity in m/s^2.
    pub gravity: Vec3,
    /// The wind that blows everywhere.
    pub wind: Wind,
    /// Places with a wind of their own.
    pub wind_zones: Vec<WindZone>,
    /// Time in seconds since the start, by which gusts go.
    pub time: f64,
    /// The obstacles.
    pub obstacles: Obstacles,
}

impl Default for Environment {
    fn default() -> Self {
        Self {
            dt: 1.0 / 60.0,
            gravity: Vec3::new(0.0, -9.81, 0.0),
            wind: Wind::default(),
            wind_zones: Vec::new(),
            time: 0.0,
            obstacles: Obstacles::new(),
        }
    }
}

/// Bodies and balls that are stepped together.
#[derive(Clone, Debug, Default)]
pub struct Island {
    /// Cloths, ropes and rigs.
    pub bodies: Vec<Body>,
    /// Cannon balls.
    pub balls: Vec<Ball>,
    /// What touched what in the last step, balls first by index.
    pub touches: Vec<Touch>,
    /// What happened in the last step to whoever [reports](Body::reports_contacts) it: one contact for each two, bodies
    /// first by index.
    pub contacts: Vec<Contact>,
    /// What was done in the last step to obstacles that [ask](crate::Obstacle::reporting_reaction) for it, by index.
    pub reactions: Vec<Reaction>,
    /// Where the last step has brought obstacles with [rigid bodies](crate::Obstacle::with_rigid_body) that something was
    /// near, by index.
    pub moved: Vec<MovedObstacle>,
    /// The instruction set to run on; the bits do not depend on it.
    pub isa: Isa,
    /// Scratch of the step.
    pub context: IslandContext,
}

/// What an island needs during a step, kept so that a step allocates nothing once warm.
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
    /// Obstacles near a ball, while the search looks at it.
    pub(crate) near_obstacles: Vec<u32>,
    pub(crate) ball_obstacle: Vec<BallObstacle>,
    pub(crate) ball_cloth: Vec<BallCloth>,
    pub(crate) ball_pairs: Vec<BallPair>,
    pub(crate) self_contacts: SelfContacts,
    pub(crate) report: ContactReport,
    pub(crate) reactions: Reactions,
    pub(crate) movers: Vec<Mover>,
    pub(crate) impact_zones: ImpactZones,
    pub(crate) ball_search: BallSearch,
    /// Places of the particles that a ball touches, while tethers are projected.
    pub(crate) touched: Vec<(usize, Vec3)>,
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

    /// Takes everything out, keeping the memory.
    pub fn clear(&mut self) {
        self.bodies.clear();
        self.balls.clear();
        self.touches.clear();
        self.contacts.clear();
        self.reactions.clear();
        self.moved.clear();
    }

    /// Takes the body at `index` out in the middle of a step: an empty one is left in its place, and nothing touches
    /// it any more. The other bodies keep their indices.
    pub fn vacate_body(&mut self, index: usize) {
        self.bodies[index] = Body::default();
        self.context.ball_cloth.retain(|contact| contact.body != index);
        self.context.ball_search.forget(self.context.ball_cloth.len());
        self.context.self_contacts.forget(index);
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

    /// The most iterations that a body takes.
    pub(crate) fn iterations(&self) -> u32 {
        self.bodies.iter().map(|body| body.settings.iterations).max().unwrap_or(1)
    }

    /// Iterations that the last substep took: fewer than asked for where a body's
    /// [tolerance](crate::SolverSettings::tolerance) let it stop early.
    pub fn iterations_taken(&self) -> u32 {
        self.context.iterations_taken
    }

    /// Pairs of particles that [self-contact](crate::SolverSettings::self_contact) watches: what it costs grows with
    /// their number.
    pub fn self_contact_pairs(&self) -> usize {
        self.context.self_contacts.pair_count()
    }

    /// Substeps of the step that was [begun](crate::step::begin).
    pub fn substeps(&self) -> u32 {
        self.context.substeps
    }
}
