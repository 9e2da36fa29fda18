//! Quantities of sets of entities: energy, momentum, stretch and so on.

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::drape_solver::state::measure;
use bevy_drape::drape_solver::{self, StateHasher, StickBatch, StickKind};
use bevy_drape::prelude::*;

use super::simulated_entities::SimulatedEntities;
use crate::scene::{Energy, Measure};

pub(super) fn bodies<'a>(
    world: &'a World,
    simulated: &'a SimulatedEntities,
) -> impl Iterator<Item = &'a Particles> {
    simulated.bodies.iter().filter_map(|&body| world.get::<Particles>(body))
}

fn balls<'a>(
    world: &'a World,
    simulated: &'a SimulatedEntities,
) -> impl Iterator<Item = &'a ProjectileState> {
    simulated.balls.iter().filter_map(|&ball| world.get::<ProjectileState>(ball))
}

fn dynamics<'a>(
    world: &'a World,
    simulated: &'a SimulatedEntities,
) -> impl Iterator<Item = (&'a DynamicObstacle, &'a Transform)> {
    simulated
        .obstacles
        .iter()
        .filter_map(|&obstacle| world.get::<DynamicObstacle>(obstacle).zip(world.get(obstacle)))
}

/// The greatest speed in m/s: of bodies the root mean square over their particles.
pub(super) fn speed(world: &World, simulated: &SimulatedEntities) -> f64 {
    let of_bodies = bodies(world, simulated).map(|body| f64::from(measure::mean_square_speed(body)).sqrt());
    let of_balls = balls(world, simulated).map(|ball| ball.velocity().as_dvec3().length());
    let of_dynamics = dynamics(world, simulated).map(|(dynamic, _)| dynamic.velocity.as_dvec3().length());
    of_bodies.chain(of_balls).chain(of_dynamics).fold(0.0, f64::max)
}

/// Least and greatest corner of the box around bodies and balls, in metres.
pub(super) fn bounds(world: &World, simulated: &SimulatedEntities) -> Option<(Vec3, Vec3)> {
    let of_bodies = bodies(world, simulated).map(|body| body.bounds());
    let of_balls = balls(world, simulated).map(|ball| {
        let radius = ball.material().radius;
        (ball.position() - radius, ball.position() + radius)
    });
    of_bodies.chain(of_balls).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// The greatest stretch of a body, as a fraction of the rest length.
pub(super) fn stretch(world: &World, simulated: &SimulatedEntities, kind: Measure) -> f64 {
    let of_body = |&body: &Entity| {
        let (Some(particles), Some(sticks)) = (world.get::<Particles>(body), world.get::<Sticks>(body))
        else {
            return 0.0;
        };
        match kind {
            Measure::Rms => measure::stretch(particles, sticks).rms,
            Measure::Max => measure::stretch(particles, sticks).max,
            Measure::P99 => {
                let structural =
                    sticks.batches().iter().filter(|batch| batch.material.kind == StickKind::Structural);
                let mut strains: Vec<f64> = structural
                    .flat_map(StickBatch::range)
                    .map(|stick| {
                        let [a, b] = sticks.stick(stick).map(|end| particles.local_position(end as usize));
                        (f64::from(a.distance(b)) / f64::from(sticks.rest_length(stick)) - 1.0).abs()
                    })
                    .collect();
                strains.sort_unstable_by(f64::total_cmp);
                strains.get(strains.len().saturating_sub(1) * 99 / 100).copied().unwrap_or(0.0)
            }
        }
    };
    simulated.bodies.iter().map(of_body).fold(0.0, f64::max)
}

/// The number of edges that pass through faces.
pub(super) fn crossings(world: &World, simulated: &SimulatedEntities) -> usize {
    let bodies = simulated.bodies.iter();
    let parts = |&body: &Entity| {
        let (particles, sticks) = (world.get::<Particles>(body)?, world.get::<Sticks>(body)?);
        Some((&**particles, &*sticks.0))
    };
    measure::crossings(bodies.filter_map(parts))
}

/// The volume in units of the rest volume; of several bodies, the one farthest from 1.
pub(super) fn volume(world: &World, simulated: &SimulatedEntities) -> Option<f64> {
    let of_body = |&body: &Entity| {
        let (particles, sticks) = (world.get::<Particles>(body)?, world.get::<Sticks>(body)?);
        Some(drape_solver::volume(particles, sticks) / sticks.rest_volume()?)
    };
    simulated.bodies.iter().filter_map(of_body).max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))
}

/// Energy in joules, with the spin of dynamic obstacles.
pub(super) fn energy(world: &World, simulated: &SimulatedEntities, kind: Energy) -> f64 {
    let gravity = world.resource::<DrapeGravity>().0;
    let mut kinetic = 0.0;
    let mut potential = 0.0;
    for body in bodies(world, simulated) {
        kinetic += measure::kinetic_energy(body);
        potential += measure::potential_energy(body, gravity);
    }
    let of_height = |mass: f32, place: Vec3| -f64::from(mass) * gravity.as_dvec3().dot(place.as_dvec3());
    for ball in balls(world, simulated) {
        kinetic += f64::from(ball.kinetic_energy());
        potential += of_height(ball.material().mass, ball.position());
    }
    for (dynamic, place) in dynamics(world, simulated) {
        let spin = (place.rotation.inverse() * dynamic.angular_velocity).as_dvec3();
        kinetic += 0.5 * f64::from(dynamic.mass) * dynamic.velocity.as_dvec3().length_squared();
        kinetic += 0.5 * spin.dot(spin * dynamic.inertia.as_dvec3());
        potential += of_height(dynamic.mass * dynamic.gravity_scale, place.translation);
    }
    match kind {
        Energy::Kinetic => kinetic,
        Energy::Potential => potential,
        Energy::Mechanical => kinetic + potential,
    }
}

/// Linear momentum in kg m/s.
pub(super) fn momentum(world: &World, simulated: &SimulatedEntities) -> DVec3 {
    let of_bodies = bodies(world, simulated).map(|body| measure::momentum(body));
    let of_balls =
        balls(world, simulated).map(|ball| ball.velocity().as_dvec3() * f64::from(ball.material().mass));
    let of_dynamics =
        dynamics(world, simulated).map(|(dynamic, _)| dynamic.velocity.as_dvec3() * f64::from(dynamic.mass));
    of_bodies.chain(of_balls).chain(of_dynamics).sum()
}

/// Angular momentum about the origin in kg m^2/s, without spin.
pub(super) fn angular_momentum(world: &World, simulated: &SimulatedEntities) -> DVec3 {
    let of_bodies = bodies(world, simulated).map(|body| measure::angular_momentum(body));
    let of_balls = balls(world, simulated).map(|ball| {
        ball.position().as_dvec3().cross(ball.velocity().as_dvec3()) * f64::from(ball.material().mass)
    });
    let of_dynamics = dynamics(world, simulated).map(|(dynamic, place)| {
        place.translation.as_dvec3().cross(dynamic.velocity.as_dvec3()) * f64::from(dynamic.mass)
    });
    of_bodies.chain(of_balls).chain(of_dynamics).sum()
}

/// The liveliest activity, as a word.
pub(super) fn activity(world: &World, simulated: &SimulatedEntities) -> Option<String> {
    let states =
        simulated.bodies.iter().chain(&simulated.balls).filter_map(|&entity| world.get::<Activity>(entity));
    let liveliest = states.min_by_key(|activity| match activity {
        Activity::Active => 0,
        Activity::Resting => 1,
        Activity::Frozen => 2,
        Activity::Culled => 3,
    })?;
    Some(format!("{liveliest:?}"))
}

/// A hash of positions and velocities.
pub(super) fn state_hash(world: &World, simulated: &SimulatedEntities) -> u64 {
    let mut hasher = StateHasher::new();
    for body in bodies(world, simulated) {
        hasher.particles(body);
    }
    for ball in balls(world, simulated) {
        hasher.ball(ball);
    }
    for (dynamic, place) in dynamics(world, simulated) {
        hasher
            .numbers(&place.translation.to_array())
            .numbers(&place.rotation.to_array())
            .numbers(&dynamic.velocity.to_array())
            .numbers(&dynamic.angular_velocity.to_array());
    }
    hasher.finish()
}
