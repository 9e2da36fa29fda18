//! Points of bodies: particles by number, centres of mass.

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;
use bevy_drape::rig::InRig;

use super::named_entity::NamedEntity;
use super::scene_entities::SceneEntities;
use crate::scene::Point;

/// Position in metres and velocity in m/s of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointState {
    pub position: DVec3,
    pub velocity: DVec3,
}

/// The particles of a body, each as an entity and the index there; none if the body has not been built yet.
pub(super) fn particles(world: &World, entities: &SceneEntities, name: &str) -> Option<Vec<(Entity, usize)>> {
    let Some(named) = entities.get(name) else {
        return of_body(world, entities.numbered(name)?);
    };
    match named {
        NamedEntity::Body { body, .. } => of_body(world, *body),
        NamedEntity::Rig { particles, .. } => particles
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

/// The particle of a point among `all` particles of a body; none for the centre.
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

/// Position and velocity of a point; none while it does not exist.
pub(super) fn state(
    world: &World,
    entities: &SceneEntities,
    name: &str,
    point: &Point,
) -> Option<PointState> {
    if let Some(all) = particles(world, entities, name)
        && let Some((body, index)) = particle_at(world, point, &all)
    {
        let body = world.get::<Particles>(body)?;
        let (position, velocity) = (body.position(index).as_dvec3(), body.velocity(index).as_dvec3());
        return Some(PointState { position, velocity });
    }
    if *point == Point::Centre { centre(world, entities, name) } else { None }
}

/// The centre of mass of all free particles and balls; the mean position, if all are pinned.
fn centre(world: &World, entities: &SceneEntities, name: &str) -> Option<PointState> {
    let simulated = entities.simulated(world, [&name.to_string()]);
    if let [obstacle] = simulated.obstacles[..] {
        let position = world.get::<Transform>(obstacle)?.translation.as_dvec3();
        let velocity = world.get::<DynamicObstacle>(obstacle).map_or(Vec3::ZERO, |dynamic| dynamic.velocity);
        return Some(PointState { position, velocity: velocity.as_dvec3() });
    }
    let mut sum = (0.0, DVec3::ZERO, DVec3::ZERO);
    let mut fixed = (0.0, DVec3::ZERO);
    for body in simulated.bodies.iter().filter_map(|&body| world.get::<Particles>(body)) {
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
    for ball in simulated.balls.iter().filter_map(|&ball| world.get::<ProjectileState>(ball)) {
        let mass = f64::from(ball.material().mass);
        sum.0 += mass;
        sum.1 += ball.position().as_dvec3() * mass;
        sum.2 += ball.velocity().as_dvec3() * mass;
    }
    if sum.0 > 0.0 {
        Some(PointState { position: sum.1 / sum.0, velocity: sum.2 / sum.0 })
    } else if fixed.0 > 0.0 {
        Some(PointState { position: fixed.1 / fixed.0, velocity: DVec3::ZERO })
    } else {
        None
    }
}
