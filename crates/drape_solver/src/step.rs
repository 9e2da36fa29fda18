//! The whole step. Read this file first.
//!
//! ```text
//! begin -> accumulate forces -> detect collisions
//!       -> [ integrate -> relax x N (contacts, sticks, tethers, lines) -> project collisions, friction, zones, limits ] x substeps
//!       -> finish
//! ```
//!
//! The stages are public so that a schedule can run its own systems between them; [`step`] and [`substeps_on`] are
//! the same stages in the same order, and give the same bits.
//!
//! Friction comes last in *each* substep, on the substep's whole tangential displacement, with the depth summed
//! over its N + 1 projections. Once per step instead, a body with a friction of 0.5 slides from about 1 degree;
//! per substep, from 26.6 degrees, as Coulomb's law has it.

use glam::Vec3;

use crate::broad_phase::obstacle_search;
use crate::broad_phase::obstacle_search::Span;
use crate::constants::{BALL_TRAVEL_PER_SUBSTEP, LEAST_SHARED_CELLS, MAX_SUBSTEPS, ROUNDS_OF_LAYERS};
use crate::constraint::angular_momentum;
use crate::constraint::motion_limit;
use crate::constraint::stick;
use crate::constraint::strain::greatest_strain;
use crate::constraint::volume;
use crate::contact::ball_ball;
use crate::contact::ball_cloth;
use crate::contact::ball_obstacle;
use crate::contact::cloth_cloth as contact_self;
use crate::contact::dynamic_obstacle;
use crate::contact::embedded_obstacle;
use crate::contact::face_obstacle;
use crate::contact::impact_zone;
use crate::contact::particle_dynamic;
use crate::contact::reaction;
use crate::contact::report as contact_report;
use crate::error::{StepError, in_range};
use crate::motion::force;
use crate::motion::integrate as verlet;
use crate::motion::rest;
use crate::motion::wind::WindZone;
use crate::parallel::threads::{Alone, Threads};
use crate::parallel::workers::Crew;
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::island::{Environment, Island, IslandContext};
use crate::substep::sweep::{self, Surroundings};

/// Advances an island by `environment.dt` seconds, on this thread.
///
/// # Errors
/// [`StepError`] if the time step, the environment or a body's settings are invalid: nothing has moved then; or
/// if the state of a body or ball is no longer finite.
pub fn step(island: &mut Island, environment: &Environment) -> Result<(), StepError> {
    step_on(island, environment, &Alone)
}

/// The same on several threads, to the same bits: large bodies are shared out.
///
/// # Errors
/// As [`step`].
pub fn step_on(
    island: &mut Island,
    environment: &Environment,
    threads: &dyn Threads,
) -> Result<(), StepError> {
    let mut outcome = Ok(());
    Crew::run(lent(island, threads), &mut |crew| {
        outcome = begin(island, environment).and_then(|()| {
            accumulate_forces(island, environment);
            detect(island, environment, crew);
            substeps(island, environment, crew);
            finish_with(island, crew)
        });
    });
    outcome
}

/// All substeps that are left of the step that was [begun](begin). Where no ball is near, each body takes them in
/// turn, a large one down its strips with the stages of several substeps at once.
pub fn substeps_on(island: &mut Island, environment: &Environment, threads: &dyn Threads) {
    Crew::run(lent(island, threads), &mut |crew| substeps(island, environment, crew));
}

/// The threads, if the island has a body that is worth sharing out.
fn lent<'a>(island: &Island, threads: &'a dyn Threads) -> &'a dyn Threads {
    let is_large = |body: &Body| body.topology.layout.cells() >= 2 * LEAST_SHARED_CELLS;
    if island.bodies.iter().any(is_large) { threads } else { &Alone }
}

fn substeps(island: &mut Island, environment: &Environment, crew: &Crew) {
    let context = &island.context;
    let is_fused = island.balls.is_empty() && !context.report.is_on() && !context.reactions.is_on();
    if is_fused && island.bodies.iter().all(sweep::is_all_stages) {
        let around = surroundings(&island.context, island.isa, environment);
        for body in &mut island.bodies {
            sweep::substeps(body, around, crew);
        }
        island.context.iterations_taken = island.iterations();
        island.context.substep_index = island.context.substeps;
        count_conflicts(island, environment);
    }
    while island.context.substep_index < island.context.substeps {
        substep(island, environment);
    }
}

/// One substep: the three stages that a schedule may run one by one.
pub fn substep(island: &mut Island, environment: &Environment) {
    integrate(island, environment);
    relax(island, environment);
    project_collisions(island, environment);
}

/// Checks the input, settles the number of substeps and everything that depends on it.
///
/// The island takes the substeps of its most demanding body; a ball that would cross more than half its radius
/// in a substep asks for more, so that it cannot jump over a cloth; a heavy one near a light cloth, for more still; so
/// do two cloths that fly at each other.
///
/// # Errors
/// [`StepError`] as [`step`].
pub fn begin(island: &mut Island, environment: &Environment) -> Result<(), StepError> {
    let dt = environment.dt;
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(StepError::BadTimestep(dt));
    }
    if !environment.gravity.is_finite() {
        return Err(StepError::BadEnvironment("gravity"));
    }
    environment.wind.validate()?;
    environment.wind_zones.iter().try_for_each(WindZone::validate)?;
    island.bodies.iter_mut().for_each(Body::prepare);
    check_finite(island)?;
    let mut substeps = 1;
    for (index, body) in island.bodies.iter().enumerate() {
        body.settings.validate().map_err(|source| StepError::BadSettings { body: index, source })?;
        in_range("pressure", body.pressure, 0.0, 1e3)
            .map_err(|source| StepError::BadSettings { body: index, source })?;
        substeps = substeps.max(body.settings.substeps);
    }
    for ball in &mut island.balls {
        let path = (ball.velocity().length() + environment.gravity.length() * dt) * dt;
        let wanted = path / (ball.material.radius * BALL_TRAVEL_PER_SUBSTEP);
        ball.hit_substeps = ball_cloth::hit_substeps(ball, &island.bodies, path);
        substeps = substeps.max(wanted.max(ball.hit_substeps).min(MAX_SUBSTEPS as f32).ceil() as u32);
    }
    let wanted = contact_self::hit_substeps(&island.bodies, dt);
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
    for body in &mut island.bodies {
        body.begin_step(h, substeps, iterations);
    }
    for ball in &mut island.balls {
        ball.set_substep(h, environment.gravity);
        ball.drag = verlet::Drag::new(ball.material.drag, h);
    }
    Ok(())
}

/// Clears the accelerations of the last step and sums up those of this one: gravity, wind and the forces that
/// were added to particles and balls.
pub fn accumulate_forces(island: &mut Island, environment: &Environment) {
    for body in &mut island.bodies {
        force::accumulate(body, environment);
    }
}

/// Lists what could touch what within the step.
pub fn detect_collisions(island: &mut Island, environment: &Environment) {
    detect(island, environment, &Crew::default());
}

fn detect(island: &mut Island, environment: &Environment, crew: &Crew) {
    let (dt, gravity) = (environment.dt, environment.gravity.length());
    let fastest_ball = island.balls.iter().map(|b| b.velocity().length()).fold(0.0, f32::max);
    // A ball can bring the cloth to its own speed within the step, and what was edited is pulled into place.
    let speed_of = |body: &Body| body.particles.greatest_speed() + body.pull() / dt;
    let speed = island.bodies.iter().map(speed_of).fold(fastest_ball, f32::max);
    let reach = (speed + gravity * dt) * dt + crate::constants::CONTACT_MARGIN;
    let span = Span { dt, substeps: island.context.substeps, reach };
    for body in &mut island.bodies {
        obstacle_search::detect(body, &environment.obstacles, span, island.isa, crew);
    }
    ball_obstacle::detect(island, &environment.obstacles, dt, gravity);
    ball_ball::detect(island, dt, gravity);
    ball_cloth::detect(island, dt, gravity, speed);
    impact_zone::begin_step(island);
    contact_report::detect(island, environment, reach);
    reaction::detect(island, &environment.obstacles);
    dynamic_obstacle::detect(island, &environment.obstacles);
}

/// Stage 1 of a substep: particles and balls fly freely for one substep.
pub fn integrate(island: &mut Island, environment: &Environment) {
    dynamic_obstacle::begin_substep(island);
    let around = surroundings(&island.context, island.isa, environment);
    for body in &mut island.bodies {
        sweep::integrate(body, around);
        face_obstacle::begin_substep(body, around, &island.context.movers);
        embedded_obstacle::begin_substep(body);
    }
    for ball in &mut island.balls {
        let acceleration = environment.gravity + ball.force * ball.inverse_mass;
        ball.displacement = ball.drag.step(ball.displacement, acceleration, ball.substep);
        ball.position += ball.displacement;
        ball.projected = Vec3::ZERO;
    }
    ball_obstacle::begin_substep(island, &environment.obstacles);
    ball_ball::begin_substep(island);
    ball_cloth::begin_substep(island);
    contact_self::begin_substep(island);
}

/// Stage 2 of a substep: N times contacts, sticks, tethers, lines. May stop after any iteration; the next step goes
/// on from there.
pub fn relax(island: &mut Island, environment: &Environment) {
    for index in 0..island.iterations() {
        if index.is_power_of_two() && is_relaxed(island) {
            break;
        }
        island.context.iterations_taken = index + 1;
        project_contacts(island, environment, index);
        let around = surroundings(&island.context, island.isa, environment);
        let Island { bodies, balls, context, .. } = &mut *island;
        for (place, body) in bodies.iter_mut().enumerate() {
            sweep::relax(body, around, index);
            ball_cloth::note_touched(context, balls, place, &body.particles);
            sweep::tether(body, around, index);
            ball_cloth::put_back(context, &mut body.particles);
            sweep::solve_lines(body, around, index);
            volume::project(body);
        }
    }
    island.bodies.iter_mut().for_each(angular_momentum::restore);
}

/// Whether the sticks of all bodies are as near to their rest lengths as they were asked to be.
fn is_relaxed(island: &Island) -> bool {
    island.bodies.iter().all(|body| {
        let tolerance = body.settings.tolerance;
        tolerance > 0.0 && greatest_strain(body) <= tolerance
    })
}

/// Stage 3 of a substep: contacts have the last word on positions; then velocities follow, what bounces bounces, and
/// friction; zones, where a ball would have passed through a cloth; and limits on motion.
pub fn project_collisions(island: &mut Island, environment: &Environment) {
    project_contacts(island, environment, island.iterations());
    let around = surroundings(&island.context, island.isa, environment);
    for body in &mut island.bodies {
        sweep::update(body, around);
        stick::damp(&mut body.particles, &body.topology, &body.context.damping);
        sweep::apply_friction(body, around);
        face_obstacle::apply_friction(body, around, &mut island.context.movers);
        embedded_obstacle::apply_friction(body, around, &mut island.context.movers);
        particle_dynamic::apply_friction(body, around, &mut island.context.movers);
    }
    for ball in &mut island.balls {
        ball.displacement = ball.travel();
        ball.projected = Vec3::ZERO;
    }
    ball_obstacle::rebound(island, &environment.obstacles);
    ball_ball::rebound(island);
    ball_obstacle::apply_friction(island, &environment.obstacles);
    ball_ball::apply_friction(island);
    ball_cloth::apply_friction(island);
    contact_self::apply_friction(island);
    impact_zone::enforce(island);
    for ball in &mut island.balls {
        ball.turn();
    }
    contact_report::gather(island, environment);
    reaction::gather(island, environment);
    let around = surroundings(&island.context, island.isa, environment);
    for body in &mut island.bodies {
        sweep::finish(body, around);
    }
    island.context.substep_index += 1;
    if island.context.substep_index == island.context.substeps {
        count_conflicts(island, environment);
    }
}

/// Counts what limits on motion keep in obstacles.
fn count_conflicts(island: &mut Island, environment: &Environment) {
    let around = surroundings(&island.context, island.isa, environment);
    for body in &mut island.bodies {
        motion_limit::count_conflicts(body, around);
    }
}

/// Ends the step: forgets forces and pin targets, keeps the account of rest, brings local origins near.
///
/// # Errors
/// [`StepError::NonFiniteBody`] or [`StepError::NonFiniteBall`].
pub fn finish(island: &mut Island) -> Result<(), StepError> {
    finish_with(island, &Crew::default())
}

fn finish_with(island: &mut Island, crew: &Crew) -> Result<(), StepError> {
    for body in &mut island.bodies {
        body.particles.renew_survey(crew);
    }
    check_finite(island)?;
    let dt = island.context.substep * island.context.substeps as f32;
    for body in &mut island.bodies {
        rest::account_body(body, dt);
        let particles = &mut body.particles;
        particles.clear_requests();
        particles.limits.arrive();
        particles.disturbed = false;
        rest::recentre(particles);
    }
    for ball in &mut island.balls {
        rest::account_ball(ball, dt);
        ball.force = Vec3::ZERO;
        ball.disturbed = false;
    }
    contact_report::finish(island);
    reaction::finish(island);
    dynamic_obstacle::finish(island);
    Ok(())
}

/// Everything that touches, once: cloth against cloth, cloth and balls against obstacles, balls against each other and
/// the cloth. `index` is the number of the projection in the substep. Ropes meet in each: one turn of a knot holds all that hangs
/// on it.
fn project_contacts(island: &mut Island, environment: &Environment, index: u32) {
    if index == island.iterations() {
        project_layers(island, environment, index);
    } else if contact_self::is_on_ropes(island) {
        contact_self::project(island);
    }
    ball_cloth::project(island);
    ball_ball::project(island);
    ball_obstacle::project(island, &environment.obstacles);
    let around = surroundings(&island.context, island.isa, environment);
    for body in &mut island.bodies {
        face_obstacle::project(body, around, &mut island.context.movers);
        embedded_obstacle::project(body, around, &mut island.context.movers);
        sweep::project_contacts(body, around, index);
        particle_dynamic::project(body, around, &mut island.context.movers, index == 0);
    }
}

/// Cloth against cloth and the obstacles below, in turn: what lies in layers on an obstacle is held up by it through all
/// layers below. Dear, and as good once a substep: after the sticks.
fn project_layers(island: &mut Island, environment: &Environment, index: u32) {
    contact_self::project(island);
    for _ in 1..ROUNDS_OF_LAYERS {
        if !island.context.self_contacts.is_near() {
            return;
        }
        let around = surroundings(&island.context, island.isa, environment);
        for body in island.bodies.iter_mut().filter(|body| contact_self::is_on(body)) {
            sweep::project_contacts(body, around, index);
            particle_dynamic::project(body, around, &mut island.context.movers, false);
        }
        contact_self::project(island);
    }
}

fn surroundings<'a>(context: &IslandContext, isa: Isa, environment: &'a Environment) -> Surroundings<'a> {
    Surroundings {
        obstacles: &environment.obstacles,
        substep_index: context.substep_index,
        substeps: context.substeps,
        substep: context.substep,
        isa,
    }
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
