//! Known touches, so that none is reported twice.

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;

use crate::contact::contact_pairs::{ContactPair, ContactPairs};
use crate::contact::hit::Touching;
use crate::snapshot::key::{Key, Keys, entities, entity};

/// Pairs that touch, or touched a moment ago.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ContactSnapshot {
    /// Ball, other, and the time in seconds at which the touch ends.
    touches: Vec<(Key, Key, f64)>,
    pairs: Vec<(Key, Key, ContactPair)>,
}

/// Takes the touches of the chosen with anything.
pub(super) fn take(world: &World, all: &Keys, chosen: &Keys) -> ContactSnapshot {
    let key_of: EntityHashMap<Key> = all.iter().map(|&(key, entity)| (entity, key)).collect();
    let chosen = entities(chosen);
    let pair = |(a, b): (Entity, Entity)| {
        let is_of_chosen = chosen.contains(&a) || chosen.contains(&b);
        if is_of_chosen { Some((*key_of.get(&a)?, *key_of.get(&b)?)) } else { None }
    };
    let touches = world.resource::<Touching>().iter();
    let pairs = world.resource::<ContactPairs>().iter();
    ContactSnapshot {
        touches: touches.filter_map(|(entities, until)| pair(entities).map(|(a, b)| (a, b, until))).collect(),
        pairs: pairs.filter_map(|(entities, how)| pair(entities).map(|(a, b)| (a, b, how))).collect(),
    }
}

/// Restores the touches of the chosen, before and after the restoration. Those between two others go on.
pub(super) fn restore(contacts: &ContactSnapshot, world: &mut World, all: &Keys, chosen: [&Keys; 2]) {
    let named = |a, b| Some((entity(all, a)?, entity(all, b)?));
    let chosen = entities(&chosen.concat());
    let stays = |(a, b): (Entity, Entity)| !chosen.contains(&a) && !chosen.contains(&b);
    let touches: Vec<_> = (world.resource::<Touching>().iter().filter(|&(pair, _)| stays(pair)))
        .chain(contacts.touches.iter().filter_map(|&(a, b, until)| Some((named(a, b)?, until))))
        .collect();
    let pairs: Vec<_> = (world.resource::<ContactPairs>().iter().filter(|&(pair, _)| stays(pair)))
        .chain(contacts.pairs.iter().filter_map(|&(a, b, how)| Some((named(a, b)?, how))))
        .collect();
    world.resource_mut::<Touching>().replace(touches);
    world.resource_mut::<ContactPairs>().replace(pairs);
}
