//! The particle entities of hand-built rigs. Their bodies hold positions and velocities; their own records and
//! transforms are here.

use bevy::prelude::*;

use crate::rig::components::{InRig, Particle, ParticleRecord};
use crate::snapshot::key::{Keys, SnapshotError, entities};
use crate::snapshot::world::Placed;

/// One particle entity.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RigParticleSnapshot {
    order: u64,
    particle: Particle,
    index: u64,
    placed_by_us: [[f32; 3]; 2],
    placed: Placed,
}

/// Returns the simulated particles of these bodies in the order of insertion.
fn members(world: &mut World, keys: &Keys) -> Vec<(u64, Entity)> {
    let bodies = entities(keys);
    let mut particles = world.query::<(Entity, &ParticleRecord, &InRig)>();
    let particles = particles.iter(world).filter(|(.., in_rig)| bodies.contains(&in_rig.body));
    let mut members: Vec<(u64, Entity)> =
        particles.map(|(entity, record, _)| (record.order, entity)).collect();
    members.sort_unstable();
    members
}

pub(super) fn take(world: &mut World, keys: &Keys) -> Vec<RigParticleSnapshot> {
    let mut particles = Vec::new();
    for (order, entity) in members(world, keys) {
        let entity = world.entity(entity);
        let parts = (entity.get::<Particle>(), entity.get::<InRig>(), entity.get::<ParticleRecord>());
        let (Some(particle), Some(in_rig), Some(record)) = parts else { continue };
        particles.push(RigParticleSnapshot {
            order,
            particle: *particle,
            index: in_rig.index as u64,
            placed_by_us: [record.written, record.placed].map(|place| place.to_array()),
            placed: Placed::take(entity),
        });
    }
    particles
}

/// A snapshot does not hold edits of rigs: the world must have the same rigs.
pub(super) fn check(
    particles: &[RigParticleSnapshot],
    world: &mut World,
    keys: &Keys,
) -> Result<(), SnapshotError> {
    let members = members(world, keys);
    for (i, snapshot) in particles.iter().enumerate() {
        let is_same = members.get(i).is_some_and(|&(order, entity)| {
            order == snapshot.order
                && world.get::<Particle>(entity) == Some(&snapshot.particle)
                && world.get::<InRig>(entity).is_some_and(|in_rig| in_rig.index as u64 == snapshot.index)
        });
        if !is_same {
            return Err(SnapshotError::AnotherRig(snapshot.order));
        }
    }
    match members.get(particles.len()) {
        Some(&(order, _)) => Err(SnapshotError::AnotherRig(order)),
        None => Ok(()),
    }
}

/// Restores particles that have been [checked](check).
pub(super) fn restore(particles: &[RigParticleSnapshot], world: &mut World, keys: &Keys) {
    for (snapshot, (_, entity)) in particles.iter().zip(members(world, keys)) {
        let mut entity = world.entity_mut(entity);
        snapshot.placed.restore(&mut entity);
        if let Some(mut record) = entity.get_mut::<ParticleRecord>() {
            [record.written, record.placed] = snapshot.placed_by_us.map(Vec3::from_array);
        }
    }
}
