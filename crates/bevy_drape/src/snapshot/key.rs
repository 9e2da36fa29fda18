//! Keys that name bodies, balls and obstacles in every run.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use drape_solver::BuildError;
use thiserror::Error;

/// Names a body, ball or obstacle by its order of creation. Unlike entity ids it is the same in every run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Key {
    /// A cloth, rope or rig.
    Body(u64),
    /// A ball.
    Ball(u64),
    /// An obstacle.
    Obstacle(u64),
}

/// Why a snapshot cannot be restored into a world.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SnapshotError {
    /// The world has no plugin, or has not taken a step yet, or had not when the snapshot was taken.
    #[error("a snapshot is taken and restored after the first step of its scene")]
    NotStepped,
    /// The snapshot is of a part of a world, and was to be restored as a whole one.
    #[error("the snapshot is of a part of the world: restore it with the filter that it was taken with")]
    PartOfWorld,
    /// A body or obstacle of the snapshot is not in the world.
    #[error("{0:?} is not in the world: it is not the scene that the snapshot was taken of")]
    Missing(Key),
    /// A body has a different number of sticks; a torn one had when it was whole.
    #[error("{key:?} has {found} sticks in the world and {wanted} in the snapshot")]
    AnotherBody {
        /// The body.
        key: Key,
        /// The number of sticks that it has, or had when it was whole.
        found: usize,
        /// The number in the snapshot.
        wanted: usize,
    },
    /// The particles and sticks of a hand-built rig are not those of the snapshot.
    #[error("particle {0} of the hand-built rigs is not in the world as it was: rigs must be edited before")]
    AnotherRig(u64),
    /// A state is invalid.
    #[error("{key:?} cannot be what it was: {source}")]
    BadState {
        /// The body, ball or obstacle.
        key: Key,
        /// The fault.
        source: BuildError,
    },
    /// The same thing is in the snapshot twice, or out of order.
    #[error("{0:?} is in the snapshot twice, or out of order")]
    OutOfOrder(Key),
    /// A number of the clock, gravity, or the wind is invalid.
    #[error("{0} of the snapshot cannot be")]
    BadWorld(&'static str),
}

/// Entities sorted by their keys.
pub(super) type Keys = [(Key, Entity)];

/// Returns the entity of a key.
pub(super) fn entity(keys: &Keys, key: Key) -> Option<Entity> {
    keys.binary_search_by_key(&key, |&(key, _)| key).ok().map(|place| keys[place].1)
}

/// Returns all entities.
pub(super) fn entities(keys: &Keys) -> EntityHashSet {
    keys.iter().map(|&(_, entity)| entity).collect()
}

/// Fails with the first key that is not greater than the one before it.
pub(super) fn out_of_order(keys: impl Iterator<Item = Key>) -> Result<(), SnapshotError> {
    let mut last = None;
    for key in keys {
        if last >= Some(key) {
            return Err(SnapshotError::OutOfOrder(key));
        }
        last = Some(key);
    }
    Ok(())
}
