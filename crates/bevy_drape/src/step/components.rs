//! The components that islands take bodies and balls from (`IslandRun::take`), and bodies that are refused.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::world::staged_island::StepStage;
use drape_solver::{BuildError, Environment, StepError};

use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::contact_events::ContactEvents;
use crate::body::fabric::Fabric;
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks};
use crate::body::pressure::Pressure;
use crate::body::surface::BodySurface;
use crate::environment::solver_environment::SolverEnvironment;
use crate::refusal::Refusals;
use crate::step::island_run::IslandRun;
use crate::step::islands::Islands;

pub(crate) type BodyQuery<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut Particles,
        &'static Sticks,
        &'static mut BodyState,
        Has<ContactEvents>,
        Option<&'static Pressure>,
    ),
>;

pub(crate) type BallQuery<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut ProjectileState,
        &'static mut ProjectileRecord,
        Option<&'static DrapeLayers>,
        Has<ContactEvents>,
    ),
>;

/// The components of bodies and balls that a step moves into islands and back.
#[derive(SystemParam)]
pub(crate) struct StepComponents<'w, 's> {
    bodies: BodyQuery<'w, 's>,
    balls: BallQuery<'w, 's>,
    activities: Query<'w, 's, &'static mut Activity>,
    surfaces: Query<'w, 's, (Has<BodySurface>, Has<Fabric>)>,
    solver: Res<'w, SolverEnvironment>,
    refusals: ResMut<'w, Refusals>,
}

/// Forgets the refusals of bodies and balls that could take part in this step.
pub(crate) fn forget_mended(
    mut refusals: ResMut<Refusals>,
    bodies: Query<&BodyState>,
    balls: Query<&ProjectileRecord>,
) {
    if refusals.is_empty() {
        return;
    }
    refusals.forget_if(|entity, component| match component {
        "SolverSettings" | "BodySurface" | "Fabric" | "Particles" => {
            bodies.get(entity).is_ok_and(|body| !body.refused)
        }
        "ProjectileState" => balls.get(entity).is_ok_and(|ball| !ball.refused),
        _ => false,
    });
}

impl StepComponents<'_, '_> {
    /// Advances all islands to the stage `end`.
    pub fn advance(&mut self, islands: &mut Islands, end: StepStage) {
        self.run(islands, |island, environment| island.advance(environment, end));
    }

    /// Runs `stages` on all islands, with bodies and balls moved out of their components and back.
    pub fn run(
        &mut self,
        islands: &mut Islands,
        stages: impl Fn(&mut IslandRun, &Environment) + Send + Sync,
    ) {
        if islands.are_for_one_thread() {
            // One island after another through the same memory, which stays in the cache.
            let mut bodies = core::mem::take(&mut islands.bodies);
            for island in islands.live_mut() {
                core::mem::swap(&mut bodies, &mut island.staged.island.bodies);
                island.take(&mut self.bodies, &mut self.balls);
                island.is_alone = true;
                stages(island, &self.solver.environment);
                self.refuse_faulty(island, &stages);
                island.give_back(&mut self.bodies, &mut self.balls);
                core::mem::swap(&mut bodies, &mut island.staged.island.bodies);
            }
            islands.bodies = bodies;
        } else {
            for island in islands.live_mut() {
                island.take(&mut self.bodies, &mut self.balls);
            }
            islands.each(|island| stages(island, &self.solver.environment));
            for island in islands.live_mut() {
                self.refuse_faulty(island, &stages);
                island.give_back(&mut self.bodies, &mut self.balls);
            }
        }
    }

    /// Leaves invalid bodies and balls out; the others continue.
    fn refuse_faulty(&mut self, island: &mut IslandRun, stages: impl Fn(&mut IslandRun, &Environment)) {
        while let Some(error) = island.staged.error.take() {
            if self.refuse(island, &error) {
                stages(island, &self.solver.environment);
            } else {
                self.refusals.resource("Time<Fixed>, DrapeGravity or Wind", error.clone());
                island.staged.error = Some(error);
                break;
            }
        }
    }

    /// The component of a body that has the invalid number.
    fn component_with(&self, entity: Entity, error: &BuildError) -> &'static str {
        let is_of_surface = error.field().is_some_and(BodySurface::has_field);
        match self.surfaces.get(entity) {
            Ok((true, _)) if is_of_surface => "BodySurface",
            Ok((false, true)) if is_of_surface => "Fabric",
            _ => "SolverSettings",
        }
    }

    /// Leaves the body or ball that `error` names out of the simulation; false if it names none.
    fn refuse(&mut self, island: &mut IslandRun, error: &StepError) -> bool {
        const NOT_FINITE: &str = "a position, velocity, force or pin target is not finite";
        // Bypasses change detection: a change of a refused component means that the user has mended it.
        let entity = match *error {
            StepError::NonFiniteBody(index) | StepError::BadSettings { body: index, .. } => {
                let entity = island.bodies.remove(index);
                let (body, scratch) = island.staged.leave_body_out(index);
                if let Ok((mut particles, _, mut state, ..)) = self.bodies.get_mut(entity) {
                    particles.bypass_change_detection().0 = body.particles;
                    state.context = body.context;
                    state.scratch = scratch;
                    state.refused = true;
                }
                if let StepError::BadSettings { source, .. } = error {
                    let component = self.component_with(entity, source);
                    self.refusals.entity(entity, component, source.clone());
                } else {
                    self.refusals.entity(entity, "Particles", NOT_FINITE);
                }
                entity
            }
            StepError::NonFiniteBall(index) => {
                let entity = island.balls.remove(index);
                let ball = island.staged.leave_ball_out(index);
                if let Ok((mut state, mut record, ..)) = self.balls.get_mut(entity) {
                    state.bypass_change_detection().0 = ball;
                    record.refused = true;
                }
                self.refusals.entity(entity, "ProjectileState", NOT_FINITE);
                entity
            }
            _ => return false,
        };
        if let Ok(mut activity) = self.activities.get_mut(entity) {
            *activity = Activity::Culled;
        }
        true
    }
}
