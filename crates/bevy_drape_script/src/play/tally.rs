//! What touched what, and what tore: hits of balls, contacts and torn sticks, counted by names.

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::Key;
use serde::{Deserialize, Serialize};

use super::stage::Stage;
use crate::scene::{Names, whole};

/// Names of two that touch.
type Pair = (String, String);

/// What was counted so far, in a form that can be kept.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Counted {
    hits: Vec<Pair>,
    contacts: Vec<Pair>,
    touching: Vec<(Key, Key, Pair)>,
    torn: Vec<String>,
}

/// Pairs of names that began to touch.
pub(super) struct Tally {
    hits: Vec<Pair>,
    contacts: Vec<Pair>,
    /// What touches now, the names beside the entities: these may be gone when the contact ends.
    touching: Vec<(Entity, Entity, Pair)>,
    /// The names of the bodies of sticks that were torn or cut.
    torn: Vec<String>,
    hit_cursor: MessageCursor<BallHit>,
    contact_cursor: MessageCursor<DrapeContactStarted>,
    end_cursor: MessageCursor<DrapeContactEnded>,
    shot_cursor: MessageCursor<CannonFired>,
    split_cursor: MessageCursor<BodySplit>,
    torn_cursor: MessageCursor<StickTorn>,
}

impl Tally {
    /// Counts from now on.
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

    /// What was counted so far, to be kept: what touches now by the keys that `key_of` gives.
    pub fn save(&self, key_of: impl Fn(Entity) -> Option<Key>) -> Counted {
        let key = |&(body, other, ref names): &(Entity, Entity, Pair)| {
            Some((key_of(body)?, key_of(other)?, names.clone()))
        };
        Counted {
            hits: self.hits.clone(),
            contacts: self.contacts.clone(),
            touching: self.touching.iter().filter_map(key).collect(),
            torn: self.torn.clone(),
        }
    }

    /// Goes on from what was kept.
    pub fn restored(world: &World, counted: &Counted, entity_of: impl Fn(Key) -> Option<Entity>) -> Self {
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

    /// Reads the messages of the last step.
    pub fn read(&mut self, world: &mut World, stage: &mut Stage) {
        let shots: Vec<CannonFired> =
            self.shot_cursor.read(world.resource::<Messages<CannonFired>>()).copied().collect();
        for CannonFired { cannon, projectile } in shots {
            if let Some(name) = stage.note_shot(cannon, projectile)
                && let Ok(mut ball) = world.get_entity_mut(projectile)
            {
                ball.insert(Name::new(name));
            }
        }
        for split in
            self.split_cursor.read(world.resource::<Messages<BodySplit>>()).cloned().collect::<Vec<_>>()
        {
            if let Some(piece) = split.piece
                && let Some(name) = stage.note_piece(split.body, piece)
                && let Ok(mut piece) = world.get_entity_mut(piece)
            {
                piece.insert(Name::new(name));
            }
        }
        let name = |entity: Entity| stage.name_of(world, entity).unwrap_or_default();
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

    /// How many hits there were of `of` on `on`. Two balls that touch are one hit.
    pub fn hits(&self, of: &Names, on: &Names) -> usize {
        self.hits.iter().filter(|(ball, target)| matches(of, ball) && matches(on, target)).count()
    }

    /// How many contacts began between `of` and `on`.
    pub fn contacts(&self, of: &Names, on: &Names) -> usize {
        self.contacts.iter().filter(|pair| is_between(pair, of, on)).count()
    }

    /// How many sticks of `of` were torn or cut.
    pub fn torn(&self, of: &Names) -> usize {
        self.torn.iter().filter(|body| matches(of, body)).count()
    }

    /// How many pairs of `of` and `on` touch now.
    pub fn touching(&self, of: &Names, on: &Names) -> usize {
        self.touching.iter().filter(|(_, _, pair)| is_between(pair, of, on)).count()
    }
}

/// Whether one of a pair is of `of` and the other of `on`.
fn is_between((a, b): &Pair, of: &Names, on: &Names) -> bool {
    matches(of, a) && matches(on, b) || matches(of, b) && matches(on, a)
}

/// Whether `name` is one of `names`, or a ball or piece of one of them. No names are all names.
fn matches(names: &Names, name: &str) -> bool {
    names.is_empty() || names.iter().any(|given| given == name || given == whole(name))
}
