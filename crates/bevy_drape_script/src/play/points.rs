//! Points of bodies: particles by number, centres of mass.

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::stage::{Actor, Stage};
use crate::scene::Point;

/// Place and velocity of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub position: DVec3,
    pub velocity: DVec3,
}

/// The particles of a body: its entity and the index there. None if it has not been built yet.
pub(super) fn particles(world: &World, stage: &Stage, name: &str) -> Option<Vec<(Entity, usize)>> {
    let Some(actor) = stage.get(name) else {
        return of_body(world, stage.numbered(name)?);
    };
    match actor {
        Actor::Body { body, .. } => of_body(world, *body),
        Actor::Rig { particles, .. } => particles
            .iter()
            .map(|&particle| world.get::<InRig>(particle).map(|rig| (rig.body, rig.index)))
            .collect(),
        _ => None,
    }
}

fn of_body(world: &World, body: Entity) -> Option<Vec<(Entity, usize)>> {
    let count = world.get::<Particles>(body)?.len();
    Some((0..count).map(|index| (body, index)).collect())
}

/// The particle of a point among `all` of a body, and its index in its entity; none for the centre.
pub(super) fn particle_at(world: &World, point: &Point, all: &[(Entity, usize)]) -> Option<(Entity, usize)> {
    let count = all.len();
    let index = match point {
        Point::Centre => return None,
        Point::Particle(index) => *index as usize,
        Point::First => 0,
        Point::Middle => match world.get::<Cloth>(all.first()?.0) {
            Some(&Cloth { particles: UVec2 { x: columns, y: rows }, .. })
                if u64::from(columns) * u64::from(rows) == count as u64 =>
            {
                rows as usize / 2 * columns as usize + columns as usize / 2
            }
            _ => count / 2,
        },
        Point::Last => count.checked_sub(1)?,
    };
    all.get(index).copied()
}

/// Where a point is and how it moves; none while it is not there.
pub(super) fn state(world: &World, stage: &Stage, name: &str, point: &Point) -> Option<State> {
    if let Some(all) = particles(world, stage, name)
        && let Some((body, index)) = particle_at(world, point, &all)
    {
        let body = world.get::<Particles>(body)?;
        let (position, velocity) = (body.position(index).as_dvec3(), body.velocity(index).as_dvec3());
        return Some(State { position, velocity });
    }
    if *point == Point::Centre { centre(world, stage, name) } else { None }
}

/// The centre of mass of what is free; of what is wholly pinned, the mean.
fn centre(world: &World, stage: &Stage, name: &str) -> Option<State> {
    let parts = stage.parts(world, [&name.to_string()]);
    if let [obstacle] = parts.obstacles[..] {
        let position = world.get::<Transform>(obstacle)?.translation.as_dvec3();
        let velocity = world.get::<DynamicObstacle>(obstacle).map_or(Vec3::ZERO, |dynamic| dynamic.velocity);
        return Some(State { position, velocity: velocity.as_dvec3() });
    }
    let mut sum = (0.0, DVec3::ZERO, DVec3::ZERO);
    let mut fixed = (0.0, DVec3::ZERO);
    for body in parts.bodies.iter().filter_map(|&body| world.get::<Particles>(body)) {
        for i in 0..body.len() {
            let position = body.position(i).as_dvec3();
            let inverse_mass = f64::from(body.inverse_mass(i));
            if inverse_mass > 0.0 {
                let mass = 1.0 / inverse_mass;
                sum.0 += mass;
                sum.1 += position * mass;
                sum.2 += body.velocity(i).as_dvec3() * mass;
            } else {
                fixed.0 += 1.0;
                fixed.1 += position;
            }
        }
    }
    for ball in parts.balls.iter().filter_map(|&ball| world.get::<ProjectileState>(ball)) {
        let mass = f64::from(ball.material().mass);
        sum.0 += mass;
        sum.1 += ball.position().as_dvec3() * mass;
        sum.2 += ball.velocity().as_dvec3() * mass;
    }
    if sum.0 > 0.0 {
        Some(State { position: sum.1 / sum.0, velocity: sum.2 / sum.0 })
    } else if fixed.0 > 0.0 {
        Some(State { position: fixed.1 / fixed.0, velocity: DVec3::ZERO })
    } else {
        None
    }
}
