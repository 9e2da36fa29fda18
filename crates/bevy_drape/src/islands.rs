//! Islands: which bodies and balls are stepped together, and their way into the solver and back.
//!
//! The solver owns what it steps. A body's columns are moved out of its component into an island (a few pointers,
//! no copy of the particles), stepped, and moved back. Islands do not depend on each other, so they run on all
//! threads of the compute pool and give the same bits on any number of them.

use std::sync::Arc;
use std::time::Instant;

use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use drape_solver::{Body, Environment, Other, StepError, step};

use crate::activity::Activity;
use crate::clock::DrapeClock;
use crate::environment::SolverEnvironment;
use crate::hit::{BallHit, HitTarget, Touching};
use crate::particles::{BodyState, Particles, Sticks};
use crate::projectile::{ProjectileRecord, ProjectileState};
use crate::refusal::Refusals;
use crate::scene_manager::{Bounds, SceneManager, ball_reach, body_reach, overlap};
use crate::schedule::StepTimes;

/// One island: the solver's, and the entities behind its bodies and balls.
#[derive(Default)]
pub(crate) struct Island {
    pub solver: drape_solver::Island,
    pub bodies: Vec<Entity>,
    pub balls: Vec<Entity>,
    /// What the stages found: a body that cannot be stepped.
    pub outcome: Option<StepError>,
    /// Substeps taken of this step.
    taken: u32,
}

impl Island {
    /// Runs the next substep stage, if this island has substeps left.
    fn substep_stage(&mut self, environment: &Environment, stage: SubstepStage) {
        if self.outcome.is_some() || self.taken >= self.solver.substeps() {
            return;
        }
        match stage {
            SubstepStage::Integrate => step::integrate(&mut self.solver, environment),
            SubstepStage::Relax => step::relax(&mut self.solver, environment),
            SubstepStage::ProjectCollisions => {
                step::project_collisions(&mut self.solver, environment);
                self.taken += 1;
            }
        }
    }
}

impl Island {
    /// Drops the touches of a body or ball that has been taken out, and counts down the indices behind it.
    fn forget_touches(&mut self, gone: Other) {
        self.solver.touches.retain_mut(|touch| {
            if let Other::Ball(index) = gone {
                if touch.ball == index {
                    return false;
                }
                touch.ball -= usize::from(touch.ball > index);
            }
            match (&mut touch.other, gone) {
                (other, gone) if *other == gone => return false,
                (Other::Body(i), Other::Body(gone)) | (Other::Ball(i), Other::Ball(gone)) => {
                    *i -= usize::from(*i > gone);
                }
                _ => {}
            }
            true
        });
    }
}

/// The stages of a substep, in their order.
#[derive(Clone, Copy)]
pub(crate) enum SubstepStage {
    Integrate,
    Relax,
    ProjectCollisions,
}

/// The order of a substep, for the schedule and for islands that run on their own.
pub(crate) const SUBSTEP: [SubstepStage; 3] =
    [SubstepStage::Integrate, SubstepStage::Relax, SubstepStage::ProjectCollisions];

/// All islands of this step. Slots beyond `live` are kept for their memory.
#[derive(Resource, Default)]
pub(crate) struct Islands {
    slots: Vec<Island>,
    live: usize,
    members: Vec<Member>,
    parents: Vec<usize>,
    slot_of: Vec<usize>,
}

/// A body or ball on its way into an island.
#[derive(Clone, Copy)]
struct Member {
    order: u64,
    entity: Entity,
    is_ball: bool,
    /// Where it can get within the step.
    bounds: Bounds,
}

pub(crate) type BodyQuery<'w, 's> =
    Query<'w, 's, (&'static mut Particles, &'static Sticks, &'static mut BodyState)>;
pub(crate) type BallQuery<'w, 's> =
    Query<'w, 's, (&'static mut ProjectileState, &'static mut ProjectileRecord)>;

impl Islands {
    /// The islands of this step.
    pub fn live(&self) -> &[Island] {
        &self.slots[..self.live]
    }

    pub fn live_mut(&mut self) -> &mut [Island] {
        &mut self.slots[..self.live]
    }

    /// The most substeps that an island takes in this step.
    pub fn substeps(&self) -> u32 {
        self.live().iter().map(|island| island.solver.substeps()).max().unwrap_or(0)
    }

    /// Moves all bodies and balls from their components into the islands.
    pub fn take(&mut self, bodies: &mut BodyQuery, balls: &mut BallQuery) {
        for island in self.live_mut() {
            let Island { solver, bodies: entities, balls: ball_entities, .. } = island;
            solver.bodies.clear();
            for entity in entities.iter_mut() {
                let body = match bodies.get_mut(*entity) {
                    Ok((mut particles, sticks, mut state)) if fits(&particles, sticks) => Body {
                        particles: core::mem::take(&mut particles.bypass_change_detection().0),
                        topology: Arc::clone(&sticks.0),
                        settings: state.settings,
                        context: core::mem::take(&mut state.context),
                    },
                    _ => Body::default(),
                };
                let is_gone = body.particles.is_empty();
                solver.bodies.push(body);
                if is_gone {
                    // A user's system took the body away in the middle of the step.
                    solver.vacate_body(solver.bodies.len() - 1);
                    *entity = Entity::PLACEHOLDER;
                }
            }
            let is_first_time = solver.balls.is_empty();
            for (slot, &entity) in ball_entities.iter().enumerate() {
                if let Ok((state, _)) = balls.get(entity) {
                    if is_first_time {
                        solver.balls.push(state.0.clone());
                    } else {
                        solver.balls[slot].clone_from(&state.0);
                    }
                }
            }
        }
    }

    /// Moves all bodies and balls back into their components.
    pub fn give_back(&mut self, bodies: &mut BodyQuery, balls: &mut BallQuery) {
        for island in self.live_mut() {
            for (&entity, body) in island.bodies.iter().zip(island.solver.bodies.drain(..)) {
                if let Ok((mut particles, _, mut state)) = bodies.get_mut(entity) {
                    particles.0 = body.particles;
                    state.context = body.context;
                }
            }
            for (&entity, ball) in island.balls.iter().zip(&island.solver.balls) {
                if let Ok((mut state, _)) = balls.get_mut(entity) {
                    state.0.clone_from(ball);
                }
            }
        }
    }

    /// Runs `stage` on every island, on all threads of the compute pool.
    pub fn each(&mut self, stage: impl Fn(&mut Island) + Send + Sync) {
        let islands = self.live_mut();
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let threads = pool.thread_num();
        if threads < 2 || islands.len() < 2 {
            islands.iter_mut().for_each(stage);
            return;
        }
        let share = islands.len().div_ceil(threads * 4);
        pool.scope(|scope| {
            for chunk in islands.chunks_mut(share) {
                let stage = &stage;
                scope.spawn(async move { chunk.iter_mut().for_each(stage) });
            }
        });
    }

    /// Groups active bodies and balls whose boxes meet in this step: islands in order of their oldest member.
    fn form(&mut self) {
        self.members.sort_unstable_by_key(|member| member.order);
        let count = self.members.len();
        self.parents.clear();
        self.parents.extend(0..count);
        for (b, ball) in self.members.iter().enumerate().filter(|(_, member)| member.is_ball) {
            for (other, member) in self.members.iter().enumerate() {
                if other != b && overlap(ball.bounds, member.bounds) {
                    let (p, q) = (root(&mut self.parents, b), root(&mut self.parents, other));
                    self.parents[p.max(q)] = p.min(q);
                }
            }
        }
        self.live = 0;
        self.slot_of.clear();
        for i in 0..count {
            // The root of an island is its oldest member, so it has its slot before the others ask for it.
            let root = root(&mut self.parents, i);
            if root == i {
                self.open_slot();
            }
            let slot = if root == i { self.live - 1 } else { self.slot_of[root] };
            self.slot_of.push(slot);
            let (member, island) = (self.members[i], &mut self.slots[slot]);
            let list = if member.is_ball { &mut island.balls } else { &mut island.bodies };
            list.push(member.entity);
        }
    }

    fn open_slot(&mut self) {
        if self.live == self.slots.len() {
            self.slots.push(Island::default());
        }
        let island = &mut self.slots[self.live];
        island.solver.clear();
        island.bodies.clear();
        island.balls.clear();
        island.outcome = None;
        island.taken = 0;
        self.live += 1;
    }
}

/// Whether these particles and sticks belong together.
fn fits(particles: &Particles, sticks: &Sticks) -> bool {
    !particles.is_empty() && particles.len() == sticks.particle_count()
}

/// The oldest member of `i`'s group.
fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}

/// Groups all active bodies and balls into the islands of this step.
pub(crate) fn form_islands(
    mut bodies: Query<(Entity, &mut Activity, &Particles, &Sticks, &mut BodyState)>,
    balls: Query<(Entity, &Activity, &ProjectileState, &ProjectileRecord), Without<Particles>>,
    solver: Res<SolverEnvironment>,
    mut islands: ResMut<Islands>,
    mut refusals: ResMut<Refusals>,
) {
    let (dt, gravity) = (solver.environment.dt, solver.environment.gravity.length());
    islands.members.clear();
    for (entity, mut activity, particles, sticks, mut state) in &mut bodies {
        if *activity != Activity::Active || state.refused {
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
        islands.members.push(Member { order: state.order, entity, is_ball: false, bounds });
    }
    for (entity, activity, state, record) in &balls {
        if *activity == Activity::Active && !record.refused {
            let bounds = ball_reach(state, dt, gravity);
            islands.members.push(Member { order: record.order, entity, is_ball: true, bounds });
        }
    }
    islands.form();
}

/// Checks the islands and sums up the forces on them. What cannot be stepped is left out.
pub(crate) fn begin_islands(
    mut bodies: BodyQuery,
    mut balls: BallQuery,
    mut activities: Query<&mut Activity>,
    solver: Res<SolverEnvironment>,
    mut islands: ResMut<Islands>,
    mut refusals: ResMut<Refusals>,
) {
    let environment = &solver.environment;
    islands.take(&mut bodies, &mut balls);
    islands.each(|island| island.outcome = step::begin(&mut island.solver, environment).err());
    for island in islands.live_mut() {
        while let Some(error) = island.outcome.take() {
            if refuse_member(island, &error, &mut bodies, &mut balls, &mut activities, &mut refusals) {
                island.outcome = step::begin(&mut island.solver, environment).err();
            } else {
                refusals.resource("Time<Fixed>, DrapeGravity or Wind", &error);
                island.outcome = Some(error);
                break;
            }
        }
    }
    islands.each(|island| {
        if island.outcome.is_none() {
            step::accumulate_forces(&mut island.solver, environment);
        }
    });
    islands.give_back(&mut bodies, &mut balls);
}

/// Leaves the body or ball that `error` names out of the simulation; false if it names none.
fn refuse_member(
    island: &mut Island,
    error: &StepError,
    bodies: &mut BodyQuery,
    balls: &mut BallQuery,
    activities: &mut Query<&mut Activity>,
    refusals: &mut Refusals,
) -> bool {
    const NOT_FINITE: &str = "a position, velocity, force or pin target is not finite";
    // Writing to what is refused does not count as a change: a change is how a user mends it.
    let entity = match *error {
        StepError::NonFiniteBody(index) | StepError::BadSettings { body: index, .. } => {
            let entity = island.bodies.remove(index);
            let mut body = island.solver.bodies.remove(index);
            body.particles.clear_requests();
            if let Ok((mut particles, _, mut state)) = bodies.get_mut(entity) {
                particles.bypass_change_detection().0 = body.particles;
                state.context = body.context;
                state.refused = true;
            }
            if let StepError::BadSettings { source, .. } = error {
                refusals.entity(entity, "SolverSettings", source);
            } else {
                refusals.entity(entity, "Particles", NOT_FINITE);
            }
            island.forget_touches(Other::Body(index));
            entity
        }
        StepError::NonFiniteBall(index) => {
            let entity = island.balls.remove(index);
            let mut ball = island.solver.balls.remove(index);
            ball.clear_force();
            if let Ok((mut state, mut record)) = balls.get_mut(entity) {
                state.bypass_change_detection().0 = ball;
                record.refused = true;
            }
            refusals.entity(entity, "ProjectileState", NOT_FINITE);
            island.forget_touches(Other::Ball(index));
            entity
        }
        _ => return false,
    };
    if let Ok(mut activity) = activities.get_mut(entity) {
        *activity = Activity::Culled;
    }
    true
}

/// Lists what could touch what within the step.
pub(crate) fn detect_collisions(
    mut bodies: BodyQuery,
    mut balls: BallQuery,
    solver: Res<SolverEnvironment>,
    mut islands: ResMut<Islands>,
    mut times: ResMut<StepTimes>,
) {
    let start = Instant::now();
    islands.take(&mut bodies, &mut balls);
    islands.each(|island| {
        if island.outcome.is_none() {
            step::detect_collisions(&mut island.solver, &solver.environment);
        }
    });
    islands.give_back(&mut bodies, &mut balls);
    times.detect_collisions = start.elapsed();
}

/// All substeps of all islands at once: the same stages in the same order as [`substep_stage`] runs them.
pub(crate) fn run_fused_substeps(
    mut bodies: BodyQuery,
    mut balls: BallQuery,
    solver: Res<SolverEnvironment>,
    mut islands: ResMut<Islands>,
) {
    islands.take(&mut bodies, &mut balls);
    islands.each(|island| {
        for _ in 0..island.solver.substeps() {
            for stage in SUBSTEP {
                island.substep_stage(&solver.environment, stage);
            }
        }
    });
    islands.give_back(&mut bodies, &mut balls);
}

/// One stage of one substep of all islands.
pub(crate) fn substep_stage(
    In(stage): In<SubstepStage>,
    mut bodies: BodyQuery,
    mut balls: BallQuery,
    solver: Res<SolverEnvironment>,
    mut islands: ResMut<Islands>,
) {
    islands.take(&mut bodies, &mut balls);
    islands.each(|island| island.substep_stage(&solver.environment, stage));
    islands.give_back(&mut bodies, &mut balls);
}

/// Ends the step: rest, sleep, hits.
pub(crate) fn finish_islands(
    mut bodies: BodyQuery,
    mut balls: BallQuery,
    mut activities: Query<&mut Activity>,
    solver: Res<SolverEnvironment>,
    manager: Res<SceneManager>,
    clock: Res<DrapeClock>,
    mut touching: ResMut<Touching>,
    mut hits: MessageWriter<BallHit>,
    mut islands: ResMut<Islands>,
    mut refusals: ResMut<Refusals>,
) {
    islands.take(&mut bodies, &mut balls);
    islands.each(|island| {
        if island.outcome.is_none() {
            island.outcome = step::finish(&mut island.solver).err();
        }
    });
    touching.begin_step(clock.elapsed(), |ball| {
        activities.get(ball).is_ok_and(|activity| *activity != Activity::Active)
    });
    for island in islands.live_mut() {
        while let Some(error) = island.outcome.take() {
            if refuse_member(island, &error, &mut bodies, &mut balls, &mut activities, &mut refusals) {
                island.outcome = step::finish(&mut island.solver).err();
            }
        }
        report_hits(island, &solver.obstacles, clock.elapsed(), &mut touching, &mut hits);
        let solver = &island.solver;
        let is_still = |still_for: f32| still_for >= manager.sleep_time;
        let all_still = solver.bodies.iter().all(|body| is_still(body.still_for()))
            && solver.balls.iter().all(|ball| is_still(ball.still_for()));
        if manager.sleeping && all_still {
            for &entity in island.bodies.iter().chain(&island.balls) {
                if let Ok(mut activity) = activities.get_mut(entity) {
                    *activity = Activity::Resting;
                }
            }
        }
    }
    islands.give_back(&mut bodies, &mut balls);
    for &entity in islands.live().iter().flat_map(|island| &island.bodies) {
        if let Ok((particles, _, mut state)) = bodies.get_mut(entity) {
            state.measure(&particles);
        }
    }
}

fn report_hits(
    island: &Island,
    obstacles: &[Entity],
    elapsed: f64,
    touching: &mut Touching,
    hits: &mut MessageWriter<BallHit>,
) {
    for touch in &island.solver.touches {
        let projectile = island.balls[touch.ball];
        let (target, kind) = match touch.other {
            Other::Body(i) => (island.bodies[i], HitTarget::Body),
            Other::Ball(i) => (island.balls[i], HitTarget::Projectile),
            Other::Obstacle(i) => (obstacles[i], HitTarget::Obstacle),
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
