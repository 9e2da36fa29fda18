//! Counts hits of balls, contacts and torn sticks by names.

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_drape::cannon::CannonFired;
use bevy_drape::contact::{BallHit, DrapeContactEnded, DrapeContactStarted};
use bevy_drape::snapshot::Key;
use bevy_drape::tear::{BodySplit, StickTorn};
use serde::{Deserialize, Serialize};

use super::scene_entities::SceneEntities;
use crate::scene::{Names, whole};

/// The names of two things that touch.
type Pair = (String, String);

/// The counted events, as a checkpoint keeps them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CountedEvents {
    hits: Vec<Pair>,
    contacts: Vec<Pair>,
    touching: Vec<(Key, Key, Pair)>,
    torn: Vec<String>,
}

/// Events since the scene began, by names.
pub(super) struct EventCounter {
    hits: Vec<Pair>,
    contacts: Vec<Pair>,
    /// Pairs that touch now. The names stand beside the entities, which may be despawned before the contact ends.
    touching: Vec<(Entity, Entity, Pair)>,
    /// The body's name for each stick that was torn or cut.
    torn: Vec<String>,
    hit_cursor: MessageCursor<BallHit>,
    contact_cursor: MessageCursor<DrapeContactStarted>,
    end_cursor: MessageCursor<DrapeContactEnded>,
    shot_cursor: MessageCursor<CannonFired>,
    split_cursor: MessageCursor<BodySplit>,
    torn_cursor: MessageCursor<StickTorn>,
}

impl EventCounter {
    /// A counter that starts now.
    pub fn new(world: &World) -> Self {
        Self {
            hits: Vec::new(),
            contacts: Vec::new(),
            touching: Vec::new(),
            torn: Vec::new(),
            hit_cursor: world.resource::<Messages<BallHit>>().get_cursor_current(),
            contact_cursor: world.resource::<Messages<DrapeContactStarted>>().get_cursor_current(),
            end_cursor: world.resource::<Messages<DrapeContactEnded>>().get_cursor_current(),
            shot_cursor: world.resource::<Messages<CannonFired>>().get_cursor_current(),
            split_cursor: world.resource::<Messages<BodySplit>>().get_cursor_current(),
            torn_cursor: world.resource::<Messages<StickTorn>>().get_cursor_current(),
        }
    }

    /// The events so far, for a checkpoint. Pairs that touch now are kept by the keys that `key_of` gives.
    pub fn save(&self, key_of: impl Fn(Entity) -> Option<Key>) -> CountedEvents {
        let key = |&(body, other, ref names): &(Entity, Entity, Pair)| {
            Some((key_of(body)?, key_of(other)?, names.clone()))
        };
        CountedEvents {
            hits: self.hits.clone(),
            contacts: self.contacts.clone(),
            touching: self.touching.iter().filter_map(key).collect(),
            torn: self.torn.clone(),
        }
    }

    /// A counter that continues from a checkpoint.
    pub fn restored(
        world: &World,
        counted: &CountedEvents,
        entity_of: impl Fn(Key) -> Option<Entity>,
    ) -> Self {
        let entity = |&(body, other, ref names): &(Key, Key, Pair)| {
            Some((entity_of(body)?, entity_of(other)?, names.clone()))
        };
        Self {
            hits: counted.hits.clone(),
            contacts: counted.contacts.clone(),
            touching: counted.touching.iter().filter_map(entity).collect(),
            torn: counted.torn.clone(),
            ..Self::new(world)
        }
    }

    /// Reads the messages of the last step. Names new balls and pieces, and counts events.
    pub fn read(&mut self, world: &mut World, entities: &mut SceneEntities) {
        let shots: Vec<CannonFired> =
            self.shot_cursor.read(world.resource::<Messages<CannonFired>>()).copied().collect();
        for CannonFired { cannon, projectile } in shots {
            if let Some(name) = entities.add_shot(cannon, projectile)
                && let Ok(mut ball) = world.get_entity_mut(projectile)
            {
                ball.insert(Name::new(name));
            }
        }
        for split in
            self.split_cursor.read(world.resource::<Messages<BodySplit>>()).cloned().collect::<Vec<_>>()
        {
            if let Some(piece) = split.piece
                && let Some(name) = entities.add_piece(split.body, piece)
                && let Ok(mut piece) = world.get_entity_mut(piece)
            {
                piece.insert(Name::new(name));
            }
        }
        let name = |entity: Entity| entities.name_of(world, entity).unwrap_or_default();
        for hit in self.hit_cursor.read(world.resource::<Messages<BallHit>>()) {
            self.hits.push((name(hit.projectile), name(hit.target)));
        }
        for contact in self.contact_cursor.read(world.resource::<Messages<DrapeContactStarted>>()) {
            let names = (name(contact.body), name(contact.other));
            self.contacts.push(names.clone());
            self.touching.push((contact.body, contact.other, names));
        }
        for torn in self.torn_cursor.read(world.resource::<Messages<StickTorn>>()) {
            self.torn.push(name(torn.body));
        }
        for end in self.end_cursor.read(world.resource::<Messages<DrapeContactEnded>>()) {
            self.touching.retain(|&(body, other, _)| (body, other) != (end.body, end.other));
        }
        self.touching
            .retain(|&(body, other, _)| world.get_entity(body).is_ok() && world.get_entity(other).is_ok());
    }

    /// The number of hits of `of` on `on`. Two balls that touch are one hit.
    pub fn hits(&self, of: &Names, on: &Names) -> usize {
        self.hits.iter().filter(|(ball, target)| matches(of, ball) && matches(on, target)).count()
    }

    /// The number of contacts that began between `of` and `on`.
    pub fn contacts(&self, of: &Names, on: &Names) -> usize {
        self.contacts.iter().filter(|pair| is_between(pair, of, on)).count()
    }

    /// The number of sticks of `of` that were torn or cut.
    pub fn torn(&self, of: &Names) -> usize {
        self.torn.iter().filter(|body| matches(of, body)).count()
    }

    /// The number of pairs of `of` and `on` that touch now.
    pub fn touching(&self, of: &Names, on: &Names) -> usize {
        self.touching.iter().filter(|(_, _, pair)| is_between(pair, of, on)).count()
    }
}

/// True if one of the pair is among `of` and the other among `on`.
fn is_between((a, b): &Pair, of: &Names, on: &Names) -> bool {
    matches(of, a) && matches(on, b) || matches(of, b) && matches(on, a)
}

/// True if `name` is one of `names`, or a ball or piece of one of them. No names stand for all names.
fn matches(names: &Names, name: &str) -> bool {
    names.is_empty() || names.iter().any(|given| given == name || given == whole(name))
}
