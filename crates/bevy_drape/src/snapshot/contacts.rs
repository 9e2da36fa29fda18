//! Known touches, so that none is reported twice.

use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;

use crate::contact::contact_pairs::{ContactPair, ContactPairs};
use crate::contact::hit::Touching;
use crate::snapshot::key::{Key, Keys, entity};

/// Pairs that touch, or touched a moment ago.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ContactSnapshot {
    /// Ball, other, and the time in seconds at which the touch ends.
    touches: Vec<(Key, Key, f64)>,
    pairs: Vec<(Key, Key, ContactPair)>,
}

pub(super) fn take(world: &World, keys: &Keys) -> ContactSnapshot {
    let key_of: EntityHashMap<Key> = keys.iter().map(|&(key, entity)| (entity, key)).collect();
    let pair = |(a, b): (Entity, Entity)| Some((*key_of.get(&a)?, *key_of.get(&b)?));
    let touches = world.resource::<Touching>().iter();
    let pairs = world.resource::<ContactPairs>().iter();
    ContactSnapshot {
        touches: touches.filter_map(|(entities, until)| pair(entities).map(|(a, b)| (a, b, until))).collect(),
        pairs: pairs.filter_map(|(entities, how)| pair(entities).map(|(a, b)| (a, b, how))).collect(),
    }
}

pub(super) fn restore(contacts: &ContactSnapshot, world: &mut World, keys: &Keys) {
    let pair = |a, b| Some((entity(keys, a)?, entity(keys, b)?));
    let is_member: EntityHashSet = keys.iter().map(|&(_, entity)| entity).collect();
    let is_other = |(a, b): (Entity, Entity)| !is_member.contains(&a) || !is_member.contains(&b);
    let touches = contacts.touches.iter();
    let touches = touches.filter_map(|&(a, b, until)| Some((pair(a, b)?, until)));
    let mut touching = world.resource_mut::<Touching>();
    let others: Vec<_> = touching.iter().filter(|&(pair, _)| is_other(pair)).collect();
    touching.replace(others.into_iter().chain(touches).collect());
    let pairs = contacts.pairs.iter();
    let pairs = pairs.filter_map(|&(a, b, how)| Some((pair(a, b)?, how)));
    let mut known = world.resource_mut::<ContactPairs>();
    let others: Vec<_> = known.iter().filter(|&(pair, _)| is_other(pair)).collect();
    known.replace(others.into_iter().chain(pairs).collect());
}
