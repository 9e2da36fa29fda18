//! The systems that take the islands through a step.
//!
//! Each of them brings every island up to its own stage. Where they are [fused](Islands::is_fused) the first ones
//! have nothing to do, and the last one runs all stages.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::constants::CONTACT_MARGIN;
use drape_solver::{Environment, Other, StepError};

use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::particles::{BodyState, Particles, Sticks};
use crate::change_detection::collect_rows;
use crate::clock::DrapeClock;
use crate::contact::hit::{BallHit, HitTarget, Touching};
use crate::environment::dynamic_obstacle::DynamicObstacle;
use crate::environment::obstacle::{KnownObstacles, Obstacle};
use crate::environment::solver_environment::SolverEnvironment;
use crate::refusal::Refusals;
use crate::schedule::StepTimes;
use crate::sleep::scene_manager::{SceneManager, ball_reach, body_reach, grown};
use crate::step::island_run::{BallQuery, BodyQuery, IslandRun, StepStage, fits};
use crate::step::islands::{Islands, Kind, Member};
use crate::step::motion_limits::MotionLimitCounts;

/// Begins the order of what comes after all bodies and balls.
const LATEST: u64 = 1 << 63;

/// Groups all active bodies and balls into the islands of this step.
pub(crate) fn form_islands(
    mut bodies: Query<(Entity, &mut Activity, &Particles, &Sticks, &mut BodyState)>,
    balls: Query<(Entity, &Activity, &ProjectileState, &ProjectileRecord), Without<Particles>>,
    dynamic_obstacles: Query<Entity, (With<DynamicObstacle>, With<Obstacle>)>,
    solver: Res<SolverEnvironment>,
    mut islands: ResMut<Islands>,
    mut refusals: ResMut<Refusals>,
    mut active: Local<Vec<Entity>>,
) {
    let (dt, gravity) = (solver.environment.dt, solver.environment.gravity.length());
    islands.members.clear();
    for (entities, activities, ..) in bodies.contiguous_iter().into_iter().flatten() {
        collect_rows(entities, |rows| Activity::is_any_active(&activities[rows]), &mut active);
    }
    for entity in active.drain(..) {
        let Ok((_, mut activity, particles, sticks, mut state)) = bodies.get_mut(entity) else { continue };
        if state.refused {
            continue;
        }
        if !fits(particles, sticks) {
            let (count, wanted) = (particles.len(), sticks.particle_count());
            let reason = format_args!("it has {count} particles, but its Sticks join {wanted}");
            refusals.entity(entity, "Particles", reason);
            state.refused = true;
            *activity = Activity::Culled;
            continue;
        }
        let bounds = body_reach(&state, dt, gravity);
        let kind = Kind::Body { has_self_contact: state.settings.has_self_contact() };
        islands.members.push(Member { order: state.order, entity, kind, bounds });
    }
    for (entities, activities, ..) in balls.contiguous_iter().into_iter().flatten() {
        collect_rows(entities, |rows| Activity::is_any_active(&activities[rows]), &mut active);
    }
    for entity in active.drain(..) {
        let Ok((_, _, state, record)) = balls.get(entity) else { continue };
        if !record.refused {
            let bounds = ball_reach(state, dt, gravity);
            islands.members.push(Member { order: record.order, entity, kind: Kind::Ball, bounds });
        }
    }
    for (place, entity) in dynamic_obstacles.iter().enumerate() {
        if let Some(slot) = solver.obstacles.slot(entity) {
            let bounds = grown(solver.environment.obstacles[slot].swept_bounds(), CONTACT_MARGIN);
            let order = LATEST + place as u64;
            islands.members.push(Member { order, entity, kind: Kind::Obstacle, bounds });
        }
    }
    islands.form();
}

/// Checks the islands and sums up the forces on them. What cannot be stepped is left out.
pub(crate) fn begin_islands(mut islands: ResMut<Islands>, mut members: Members) {
    if !islands.is_fused {
        members.advance(&mut islands, StepStage::DetectCollisions);
    }
}

/// Lists what could touch what within the step.
pub(crate) fn detect_collisions(mut islands: ResMut<Islands>, mut members: Members) {
    if !islands.is_fused {
        members.advance(&mut islands, StepStage::Integrate);
    }
}

/// All substeps of all islands at once.
pub(crate) fn run_substeps_of_islands(mut islands: ResMut<Islands>, mut members: Members) {
    members.advance(&mut islands, StepStage::Finish);
}

/// One stage of one substep of all islands.
pub(crate) fn substep_stage(In(stage): In<StepStage>, mut islands: ResMut<Islands>, mut members: Members) {
    members.run(&mut islands, |island, environment| island.run_substep_stage(environment, stage));
}

/// What the islands are filled from, and what it takes to leave something out.
#[derive(SystemParam)]
pub(crate) struct Members<'w, 's> {
    bodies: BodyQuery<'w, 's>,
    balls: BallQuery<'w, 's>,
    activities: Query<'w, 's, &'static mut Activity>,
    solver: Res<'w, SolverEnvironment>,
    refusals: ResMut<'w, Refusals>,
}

impl Members<'_, '_> {
    /// Brings all islands up to the stage `end`.
    fn advance(&mut self, islands: &mut Islands, end: StepStage) {
        self.run(islands, |island, environment| island.advance(environment, end));
    }

    /// Runs `stages` on all islands, with their members taken out of their components and given back.
    fn run(&mut self, islands: &mut Islands, stages: impl Fn(&mut IslandRun, &Environment) + Send + Sync) {
        if islands.are_for_one_thread() {
            // Each from beginning to end, through the same memory, while it is in the cache.
            let mut bodies = core::mem::take(&mut islands.bodies);
            for island in islands.live_mut() {
                core::mem::swap(&mut bodies, &mut island.solver.bodies);
                island.take(&mut self.bodies, &mut self.balls);
                island.is_alone = true;
                stages(island, &self.solver.environment);
                self.refuse_faulty(island, &stages);
                island.give_back(&mut self.bodies, &mut self.balls);
                core::mem::swap(&mut bodies, &mut island.solver.bodies);
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

    /// Leaves out what cannot be stepped; the others go on.
    fn refuse_faulty(&mut self, island: &mut IslandRun, stages: impl Fn(&mut IslandRun, &Environment)) {
        while let Some(error) = island.error.take() {
            if self.refuse(island, &error) {
                stages(island, &self.solver.environment);
            } else {
                self.refusals.resource("Time<Fixed>, DrapeGravity or Wind", &error);
                island.error = Some(error);
                break;
            }
        }
    }

    /// Leaves the body or ball that `error` names out of the simulation; false if it names none.
    fn refuse(&mut self, island: &mut IslandRun, error: &StepError) -> bool {
        const NOT_FINITE: &str = "a position, velocity, force or pin target is not finite";
        // Writing to what is refused does not count as a change: a change is how a user mends it.
        let entity = match *error {
            StepError::NonFiniteBody(index) | StepError::BadSettings { body: index, .. } => {
                let entity = island.bodies.remove(index);
                let mut body = island.solver.bodies.remove(index);
                body.particles.clear_requests();
                if let Ok((mut particles, _, mut state, ..)) = self.bodies.get_mut(entity) {
                    particles.bypass_change_detection().0 = body.particles;
                    state.context = body.context;
                    state.refused = true;
                }
                if let StepError::BadSettings { source, .. } = error {
                    self.refusals.entity(entity, "SolverSettings", source);
                } else {
                    self.refusals.entity(entity, "Particles", NOT_FINITE);
                }
                island.solver.forget(Other::Body(index));
                entity
            }
            StepError::NonFiniteBall(index) => {
                let entity = island.balls.remove(index);
                let mut ball = island.solver.balls.remove(index);
                ball.clear_force();
                if let Ok((mut state, mut record, ..)) = self.balls.get_mut(entity) {
                    state.bypass_change_detection().0 = ball;
                    record.refused = true;
                }
                self.refusals.entity(entity, "ProjectileState", NOT_FINITE);
                island.solver.forget(Other::Ball(index));
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

/// Ends the step: rest, sleep, hits.
pub(crate) fn finish_islands(
    mut islands: ResMut<Islands>,
    mut members: Members,
    manager: Res<SceneManager>,
    clock: Res<DrapeClock>,
    mut touching: ResMut<Touching>,
    mut hits: MessageWriter<BallHit>,
    mut times: ResMut<StepTimes>,
    mut limits: ResMut<MotionLimitCounts>,
) {
    members.advance(&mut islands, StepStage::Done);
    let Members { activities, solver, .. } = &mut members;
    touching.begin_step(clock.elapsed(), |ball| {
        activities.get(ball).is_ok_and(|activity| *activity != Activity::Active)
    });
    times.detect_collisions = islands.live().iter().map(|island| island.detect_time).sum();
    times.substeps = islands.live().iter().map(|island| island.substep_time).sum();
    let conflicts = islands.live().iter().map(|island| island.limit_conflicts).sum::<usize>();
    let total_conflicts = limits.total_conflicts + conflicts as u64;
    limits.set_if_neq(MotionLimitCounts { conflicts, total_conflicts });
    for island in islands.live() {
        report_hits(island, &solver.obstacles, clock.elapsed(), &mut touching, &mut hits);
        if manager.sleeping && island.still_for >= manager.sleep_time {
            for &entity in island.bodies.iter().chain(&island.balls) {
                if let Ok(mut activity) = activities.get_mut(entity) {
                    *activity = Activity::Resting;
                }
            }
        }
    }
}

fn report_hits(
    island: &IslandRun,
    obstacles: &KnownObstacles,
    elapsed: f64,
    touching: &mut Touching,
    hits: &mut MessageWriter<BallHit>,
) {
    for touch in &island.solver.touches {
        let projectile = island.balls[touch.ball];
        let (target, kind) = match touch.other {
            Other::Body(i) => (island.bodies[i], HitTarget::Body),
            Other::Ball(i) => (island.balls[i], HitTarget::Projectile),
            Other::Obstacle(i) => (obstacles.entity(i), HitTarget::Obstacle),
        };
        if touching.note(elapsed, projectile, target) {
            hits.write(BallHit {
                projectile,
                target,
                kind,
                time: elapsed + f64::from(touch.time),
                ball_position: touch.ball_position,
                ball_velocity: touch.ball_velocity,
                point: touch.point,
                normal: touch.normal,
                impulse: touch.impulse,
            });
        }
    }
}
