//! The whole step. Read this file first.
//!
//! ```text
//! begin -> accumulate forces -> detect collisions
//!       -> [ integrate -> relax x N (contacts, sticks, tethers; lines in the last) -> project collisions, friction, zones, limits, backstops ] x substeps
//!       -> finish
//! ```
//!
//! The stages of a substep and their order stand in `substep/order.rs`, once, as data; `stages.rs` runs them, by the order of
//! that list. The public stages let a schedule run its own systems between them; [`step`] and [`substeps_on`] walk
//! the same list, and give the same bits.
//!
//! Friction comes last in *each* substep, on the substep's whole tangential displacement, with the depth summed over
//! its N + 1 projections. Applied once per step instead, a body with a friction of 0.5 slides from about 1 degree; per
//! substep, it slides from 26.6 degrees, as Coulomb's law says.
//!
//! ```
//! use drape_solver::step::{accumulate_forces, begin, detect_collisions, finish, substeps_on};
//! use drape_solver::{Alone, BodySettings, ClothBuilder, Environment, Island, StateHasher, step};
//!
//! let environment = Environment::default();
//! let mut whole = Island::of_body(ClothBuilder::new(1.0, 1.0, 8, 8).build(BodySettings::default())?);
//! let mut staged = whole.clone();
//! step(&mut whole, &environment)?;
//!
//! // The same in stages, for whoever has something to do between them.
//! begin(&mut staged, &environment)?;
//! accumulate_forces(&mut staged, &environment);
//! detect_collisions(&mut staged, &environment);
//! substeps_on(&mut staged, &environment, &Alone);
//! finish(&mut staged)?;
//! let [whole, staged] = [whole, staged].map(|i| StateHasher::new().particles(&i.bodies[0].particles).finish());
//! assert_eq!(whole, staged);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! Design: `docs/design/relaxation.md`.

use glam::Vec3;

use crate::broad_phase::obstacle_search::SearchStep;
use crate::constants::{
    BALL_TRAVEL_PER_SUBSTEP, CONTACT_MARGIN, LEAST_SHARED_CELLS, LEAST_TOUCHING_CELLS, MAX_SUBSTEPS,
};
use crate::constraint::bending_friction;
use crate::constraint::direct::thread_friction;
use crate::constraint::strain::greatest_strain;
use crate::contact::island_contacts::IslandContacts;
use crate::contact::{
    ball_ball, ball_cloth, ball_obstacle, body_contacts, dynamic_obstacle, hit_substeps, impact_zone,
    limit_conflict, reaction, report,
};
use crate::error::{StepError, in_range};
use crate::island::{Island, IslandContext};
use crate::motion::environment::Environment;
use crate::motion::{force, rest};
use crate::parallel::threads::{Alone, Threads};
use crate::parallel::workers::Workers;
use crate::stages::walk;
use crate::state::body::Body;
use crate::state::drag::Drag;
use crate::substep::begin;
use crate::substep::island_bodies::IslandBodies;
use crate::substep::sweep;

/// Advances an island by `environment.dt` seconds, on this thread.
///
/// # Errors
/// [`StepError`] if the time step, the environment or a body's settings are invalid: nothing has moved then; or
/// if the state of a body or ball is no longer finite.
pub fn step(island: &mut Island, environment: &Environment) -> Result<(), StepError> {
    step_on(island, environment, &Alone)
}

/// The same on several threads, which share large bodies and those of an island; the bits are the same.
///
/// # Errors
/// As [`step`].
pub fn step_on(
    island: &mut Island,
    environment: &Environment,
    threads: &dyn Threads,
) -> Result<(), StepError> {
    let mut outcome = Ok(());
    Workers::run(threads_for(island, threads), &mut |workers| {
        outcome = begin(island, environment).and_then(|()| {
            accumulate_forces(island, environment);
            detect(island, environment, workers);
            substeps(island, environment, workers);
            finish_with(island, workers)
        });
    });
    outcome
}

/// Takes all substeps that are left of the step that was [begun](fn@begin). If no ball is near, each body takes them in
/// turn; a large body takes the stages of several substeps in one trip down its strips.
pub fn substeps_on(island: &mut Island, environment: &Environment, threads: &dyn Threads) {
    Workers::run(threads_for(island, threads), &mut |workers| substeps(island, environment, workers));
}

/// The threads, if the island has a body that is large enough to share, or enough that may touch.
fn threads_for<'a>(island: &Island, threads: &'a dyn Threads) -> &'a dyn Threads {
    let cells = |body: &Body| body.topology.layout.cells();
    let is_large = island.bodies.iter().any(|body| cells(body) >= 2 * LEAST_SHARED_CELLS);
    let touching: usize = island.bodies.iter().filter(|body| body.has_self_contact()).map(cells).sum();
    if is_large || touching >= LEAST_TOUCHING_CELLS { threads } else { &Alone }
}

fn substeps(island: &mut Island, environment: &Environment, workers: &Workers) {
    if can_be_swept(island) && sweep_all(island, environment, workers) {
        island.context.iterations_taken = island.iterations();
        island.context.substep_index = island.context.substeps;
        count_conflicts(island, environment);
    }
    while island.context.substep_index < island.context.substeps {
        substep_on(island, environment, workers);
    }
}

/// Takes all bodies through the substeps that are left, one by one. False if surfaces may have touched: nothing has moved then.
fn sweep_all(island: &mut Island, environment: &Environment, workers: &Workers) -> bool {
    let substep = island.context.now(island.isa, environment);
    let Island { bodies, context: IslandContext { contacts, plans, .. }, .. } = island;
    let IslandContacts { surfaces, bodies: contacts, .. } = contacts;
    if !surfaces.expects_calm(bodies, substep) {
        return false;
    }
    // The steps of bodies that may touch are taken back if they do: all others wait for them.
    for may_touch in [true, false] {
        let all = bodies.iter_mut().zip(contacts.iter_mut()).zip(&mut *plans);
        for ((body, contacts), plan) in all.filter(|((body, ..), _)| body.has_self_contact() == may_touch) {
            sweep::substeps(body, &mut contacts.obstacles, plan, substep, workers);
        }
        if may_touch && !surfaces.was_calm(bodies, substep.isa) {
            return false;
        }
    }
    true
}

/// True if no stage of the island has anything to do, so that its bodies may go through their substeps one by one.
pub(crate) fn can_be_swept(island: &Island) -> bool {
    let IslandContext { contacts, report, reactions, .. } = &island.context;
    let is_alone = island.balls.is_empty() && !report.is_on() && !reactions.is_on();
    is_alone && island.bodies.iter().zip(&contacts.bodies).all(|(body, of)| sweep::can_be_swept(body, of))
}

/// One substep: the three phases that a schedule may run one by one.
pub fn substep(island: &mut Island, environment: &Environment) {
    substep_on(island, environment, &Workers::default());
}

fn substep_on(island: &mut Island, environment: &Environment, workers: &Workers) {
    integrate_on(island, environment, workers);
    relax_on(island, environment, workers);
    project_collisions_on(island, environment, workers);
}

/// Checks the input, and sets the number of substeps and everything that depends on it.
///
/// The island takes the substeps of its most demanding body. It takes more for a ball that would cross more than half
/// its radius in a substep, so that the ball cannot jump over a cloth, and more still for a heavy ball near a light
/// cloth, or for two cloths that fly at each other.
///
/// # Errors
/// [`StepError`] as [`step`].
pub fn begin(island: &mut Island, environment: &Environment) -> Result<(), StepError> {
    environment.validate()?;
    let dt = environment.dt;
    island.bodies.iter_mut().for_each(begin::prepare);
    island.fit_scratch();
    check_finite(island)?;
    let mut substeps = 1;
    for (index, body) in island.bodies.iter().enumerate() {
        body.settings.validate().map_err(|source| StepError::BadSettings { body: index, source })?;
        in_range("pressure", body.pressure, 0.0, 1e3)
            .map_err(|source| StepError::BadSettings { body: index, source })?;
        substeps = substeps.max(body.settings.substeps);
    }
    for ball in &mut island.balls {
        let path = environment.greatest_way(ball.velocity().length());
        let wanted = path / (ball.material.radius * BALL_TRAVEL_PER_SUBSTEP);
        ball.hit_substeps = hit_substeps::of_ball(ball, &island.bodies, path);
        substeps = substeps.max(wanted.max(ball.hit_substeps).min(MAX_SUBSTEPS as f32).ceil() as u32);
    }
    let wanted = hit_substeps::of_bodies(&island.bodies, dt);
    substeps = substeps.max(wanted.min(MAX_SUBSTEPS as f32).ceil() as u32);
    let h = dt / substeps as f32;
    island.context.substeps = substeps;
    island.context.substep = h;
    island.context.substep_index = 0;
    island.touches.clear();
    island.contacts.clear();
    island.context.report.clear();
    island.reactions.clear();
    island.moved.clear();
    island.context.reactions.clear();
    let iterations = island.iterations();
    for (body, plan) in island.bodies.iter_mut().zip(&mut island.context.plans) {
        let structural = begin::structural_solve(body, environment);
        begin::begin_step(body, plan, island.context.order, h, substeps, iterations, structural);
        thread_friction::follow(body, island.isa);
        bending_friction::follow(body, island.isa);
    }
    for ball in &mut island.balls {
        ball.set_substep(h, environment.gravity);
        ball.drag = Drag::new(ball.material.drag, h);
    }
    Ok(())
}

/// Clears the accelerations of the last step and sums up those of this one: gravity, wind and the forces that
/// were added to particles and balls.
pub fn accumulate_forces(island: &mut Island, environment: &Environment) {
    let isa = island.isa;
    for body in &mut island.bodies {
        force::accumulate(body, environment, isa);
    }
}

/// Lists the pairs that could touch within the step.
pub fn detect_collisions(island: &mut Island, environment: &Environment) {
    detect(island, environment, &Workers::default());
}

fn detect(island: &mut Island, environment: &Environment, workers: &Workers) {
    let (dt, gravity, obstacles) = (environment.dt, environment.gravity.length(), &environment.obstacles);
    let Island { bodies, balls, context, isa, .. } = island;
    let fastest_ball = balls.iter().map(|b| b.velocity().length()).fold(0.0, f32::max);
    // A ball can bring the cloth to its own speed within the step, and edited particles are pulled into place.
    let speed_of = |body: &Body| {
        body.particles.greatest_speed() + (begin::pull(body) + body.particles.drive_way(dt)) / dt
    };
    let speed = bodies.iter().map(speed_of).fold(fastest_ball, f32::max);
    let reach = environment.greatest_way(speed) + CONTACT_MARGIN;
    let IslandContext { contacts, plans, report, reactions, substeps, .. } = context;
    let (isa, search_step) = (*isa, SearchStep { dt, substeps: *substeps, reach });
    let mut all = IslandBodies { bodies, contacts: &mut contacts.bodies, plans };
    all.for_each(workers, &|(body, of_body, _)| {
        body_contacts::detect(of_body, body, obstacles, search_step, isa, workers);
    });
    ball_obstacle::detect(&mut contacts.ball_obstacle, balls, obstacles, dt, gravity);
    ball_ball::detect(&mut contacts.ball_ball, balls, dt, gravity);
    ball_cloth::detect(&mut contacts.ball_cloth, bodies, balls, isa, [dt, gravity, speed]);
    impact_zone::begin_step(&mut contacts.impact_zones, &mut contacts.ball_cloth.pairs, bodies, balls);
    report::detect(report, contacts, bodies, balls, obstacles, reach);
    reaction::detect(reactions, contacts, obstacles);
    dynamic_obstacle::detect(contacts, obstacles);
}

/// Phase 1 of a substep: particles and balls fly freely for one substep.
pub fn integrate(island: &mut Island, environment: &Environment) {
    integrate_on(island, environment, &Workers::default());
}

fn integrate_on(island: &mut Island, environment: &Environment, workers: &Workers) {
    walk(island, environment, workers, island.context.order.integrate());
}

/// Phase 2 of a substep: N times contacts, sticks, tethers, and bends and lines in the last. Stop after any iteration; the next step
/// continues from there.
pub fn relax(island: &mut Island, environment: &Environment) {
    relax_on(island, environment, &Workers::default());
}

fn relax_on(island: &mut Island, environment: &Environment, workers: &Workers) {
    let (order, iterations) = (island.context.order, island.iterations());
    for index in 0..iterations {
        if index.is_power_of_two() && is_relaxed(island, environment) {
            break;
        }
        island.context.iterations_taken = index + 1;
        walk(island, environment, workers, order.iteration(index));
    }
    walk(island, environment, workers, order.relaxed(iterations));
}

/// Phase 3 of a substep: projects contacts once more. Then velocities follow, with restitution, friction and impact zones
/// for balls that would have passed through a cloth; limits on motion come last.
pub fn project_collisions(island: &mut Island, environment: &Environment) {
    project_collisions_on(island, environment, &Workers::default());
}

fn project_collisions_on(island: &mut Island, environment: &Environment, workers: &Workers) {
    walk(island, environment, workers, island.context.order.project_collisions(island.iterations()));
    island.context.substep_index += 1;
    if island.context.substep_index == island.context.substeps {
        count_conflicts(island, environment);
    }
}

/// True if the strain of every body is within its tolerance, and none has lines or listed bends, which are solved in the last
/// iteration.
fn is_relaxed(island: &Island, environment: &Environment) -> bool {
    let Island { bodies, context, .. } = island;
    let substep = context.now(island.isa, environment);
    bodies.iter().zip(&context.plans).all(|(body, plan)| {
        let tolerance = body.settings.tolerance;
        let strain = || greatest_strain(body, body.particles.length_ratio(substep));
        let takes_all = !plan.plan.lines.is_empty() || !body.topology.bends.listed.is_empty();
        tolerance > 0.0 && !takes_all && strain() <= tolerance
    })
}

/// Counts the particles that limits on motion keep in obstacles.
fn count_conflicts(island: &mut Island, environment: &Environment) {
    let substep = island.context.now(island.isa, environment);
    for (body, contacts) in island.bodies.iter_mut().zip(&island.context.contacts.bodies) {
        limit_conflict::count_conflicts(&contacts.obstacles, body, substep);
    }
}

/// Ends the step: clears forces and pin targets, updates the timers of rest, moves local origins to their bodies.
///
/// # Errors
/// [`StepError::NonFiniteBody`] or [`StepError::NonFiniteBall`].
pub fn finish(island: &mut Island) -> Result<(), StepError> {
    finish_with(island, &Workers::default())
}

fn finish_with(island: &mut Island, workers: &Workers) -> Result<(), StepError> {
    for body in &mut island.bodies {
        body.particles.renew_stats(workers);
    }
    check_finite(island)?;
    let dt = island.context.substep * island.context.substeps as f32;
    for (place, body) in island.bodies.iter_mut().enumerate() {
        let mean_square_way = island.context.contacts.surfaces.mean_square_way(place, body);
        rest::account_body(body, dt, mean_square_way);
        let particles = &mut body.particles;
        particles.clear_requests();
        particles.pose.arrive();
        particles.disturbed = false;
        rest::recentre(particles);
    }
    for ball in &mut island.balls {
        rest::account_ball(ball, dt);
        ball.force = Vec3::ZERO;
        ball.disturbed = false;
    }
    let Island { bodies, balls, touches, contacts, reactions, moved, context, .. } = island;
    report::finish(&context.report, bodies, balls, touches, contacts);
    reaction::finish(&context.reactions, &context.contacts.movers, reactions);
    dynamic_obstacle::finish(&context.contacts.movers, moved);
    Ok(())
}

fn check_finite(island: &Island) -> Result<(), StepError> {
    if let Some(i) = island.bodies.iter().position(|body| !body.particles.is_finite()) {
        return Err(StepError::NonFiniteBody(i));
    }
    if let Some(i) = island.balls.iter().position(|ball| !ball.is_finite()) {
        return Err(StepError::NonFiniteBall(i));
    }
    Ok(())
}
