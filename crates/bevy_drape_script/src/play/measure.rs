//! Measures probes in a world.

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;
use bevy_drape::sleep::ActivityCounts;

use super::event_counter::EventCounter;
use super::points;
use super::quantities::{
    activity, angular_momentum, bodies, bounds, crossings, energy, momentum, speed, state_hash, stretch,
    volume,
};
use super::scene_entities::SceneEntities;
use super::simulated_entities::SimulatedEntities;
use crate::scene::{Axis, Counted, Measured, Names, Probe};

/// Measures `probe`; none while the things that it names do not exist.
pub(super) fn measure(
    world: &World,
    entities: &SceneEntities,
    counter: &EventCounter,
    probe: &Probe,
) -> Option<Measured> {
    let number = |number: f64| Some(Measured::Number(number));
    let simulated = |names| simulated(world, entities, names);
    match probe {
        Probe::Position { of, point, axis, .. } => {
            let state = points::state(world, entities, of.first()?, point)?;
            number(along(state.position, axis))
        }
        Probe::Velocity { of, point, axis, .. } => {
            let state = points::state(world, entities, of.first()?, point)?;
            number(along(state.velocity, axis))
        }
        Probe::Distance { from, to } => {
            let from = points::state(world, entities, &from.of, &from.point)?;
            let to = points::state(world, entities, &to.of, &to.point)?;
            number(from.position.distance(to.position))
        }
        Probe::Speed { of } => number(speed(world, &simulated(of)?)),
        Probe::Extent { of, axis } => {
            let (least, greatest) = bounds(world, &simulated(of)?)?;
            number(along((greatest - least).as_dvec3(), axis))
        }
        Probe::Least { of, axis } => number(along(bounds(world, &simulated(of)?)?.0.as_dvec3(), axis)),
        Probe::Greatest { of, axis } => number(along(bounds(world, &simulated(of)?)?.1.as_dvec3(), axis)),
        Probe::Stretch { of, measure } => number(stretch(world, &simulated(of)?, *measure)),
        Probe::Volume { of } => volume(world, &simulated(of)?).map(Measured::Number),
        Probe::Penetration { of } => number(penetration(world, entities, &simulated(of)?)),
        Probe::Crossings { of } => number(crossings(world, &simulated(of)?) as f64),
        Probe::Energy { of, kind, .. } => number(energy(world, &simulated(of)?, *kind)),
        Probe::Momentum { of, axis } => number(along(momentum(world, &simulated(of)?), axis)),
        Probe::AngularMomentum { of, axis } => number(along(angular_momentum(world, &simulated(of)?), axis)),
        Probe::Activity { of } => activity(world, &simulated(of)?).map(Measured::Word),
        Probe::Count(counted) => {
            let ActivityCounts { active, resting, culled, frozen } = *world.resource::<ActivityCounts>();
            let count = match counted {
                Counted::Bodies => active + resting + culled + frozen,
                Counted::Active => active,
                Counted::Resting => resting,
                Counted::Culled => culled,
            };
            number(count as f64)
        }
        Probe::Hits { of, on } => number(counter.hits(of, on) as f64),
        Probe::Contacts { of, on } => number(counter.contacts(of, on) as f64),
        Probe::Touching { of, on } => number(counter.touching(of, on) as f64),
        Probe::Pieces { of } => number(simulated(of)?.bodies.len() as f64),
        Probe::Torn { of } => number(counter.torn(of) as f64),
        Probe::StateHash { of } => {
            Some(Measured::Word(format!("{:016x}", state_hash(world, &simulated(of)?))))
        }
        // The runner measures it, after the scene.
        Probe::StepTimeRatio { .. } => None,
    }
}

fn along(vector: DVec3, axis: &Axis) -> f64 {
    match axis {
        Axis::X => vector.x,
        Axis::Y => vector.y,
        Axis::Z => vector.z,
        Axis::Length => vector.length(),
    }
}

/// Hashes the state of everything that moves by itself.
pub(super) fn hash_of_all(world: &World, entities: &SceneEntities) -> u64 {
    state_hash(world, &entities.simulated(world, []))
}

fn simulated(world: &World, entities: &SceneEntities, names: &Names) -> Option<SimulatedEntities> {
    Some(entities.simulated(world, names.iter())).filter(|simulated| !simulated.is_empty())
}

/// The greatest penetration depth in metres; 0 if nothing penetrates.
fn penetration(world: &World, entities: &SceneEntities, simulated: &SimulatedEntities) -> f64 {
    let mut deepest = 0.0_f32;
    let everything = entities.simulated(world, []);
    let solids = entities.obstacles().filter_map(|(_, entity)| {
        let obstacle = world.get::<Obstacle>(entity).filter(|obstacle| !obstacle.is_sensor)?;
        Some((obstacle.shape.solid(None).ok()??, world.get::<Transform>(entity)?))
    });
    let solids: Vec<_> = solids.collect();
    let mut look = |point: Vec3, radius: f32, own: Option<Entity>| {
        for (shape, place) in &solids {
            let local = place.rotation.inverse() * (point - place.translation);
            deepest = deepest.max(radius - shape.distance(local));
        }
        for &ball in everything.balls.iter().filter(|&&ball| Some(ball) != own) {
            if let Some(ball) = world.get::<ProjectileState>(ball) {
                deepest = deepest.max(radius + ball.material().radius - point.distance(ball.position()));
            }
        }
    };
    for body in bodies(world, simulated) {
        body.positions().for_each(|position| look(position, 0.0, None));
    }
    for &ball in &simulated.balls {
        if let Some(state) = world.get::<ProjectileState>(ball) {
            look(state.position(), state.material().radius, Some(ball));
        }
    }
    f64::from(deepest)
}
