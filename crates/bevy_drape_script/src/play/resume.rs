//! Saves the play of a scene in a checkpoint, and resumes it.

use std::collections::BTreeMap;

use bevy::prelude::*;
use bevy_drape::rig::InRig;
use bevy_drape::snapshot::{Key, members, number_from};
use serde::{Deserialize, Serialize};

use super::begin::begin_scene;
use super::command::BodyCommand;
use super::drag::Drag;
use super::event_counter::{CountedEvents, EventCounter};
use super::expectation_evaluator::ExpectationEvaluator;
use super::named_entity::NamedEntity;
use super::notes::Notes;
use super::scene_entities::SceneEntities;
use super::scene_play::ScenePlay;
use super::scheduled_event::ScheduledEvent;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::mesh::MeshFiles;
use crate::scene::{Named, SCHEMA, SceneScript};
use crate::text::{self, SceneError};

/// The state of a [`ScenePlay`], as a checkpoint keeps it. Names in `serde` attributes belong to the format.
#[derive(Clone, Serialize, Deserialize)]
struct SavedPlay {
    script: SceneScript,
    /// The meshes of the script, whose files may be elsewhere when it is resumed.
    meshes: MeshFiles,
    /// The keys of all entities, by name: of balls one each, or none once the ball is gone; of a body its own and those of its pieces.
    #[serde(rename = "actors")]
    entities: BTreeMap<String, Vec<Option<Key>>>,
    schedule: Vec<ScheduledEvent>,
    #[serde(rename = "judges")]
    evaluators: Vec<ExpectationEvaluator>,
    counted: CountedEvents,
    #[serde(rename = "orders")]
    commands: Vec<BodyCommand>,
    drags: Vec<Drag>,
    problems: Vec<String>,
    notes: Vec<String>,
    paused_for: u64,
    steps: u64,
    began: (u64, f64),
    is_stopping: bool,
    is_over: bool,
}

impl ScenePlay {
    /// Its state as text.
    pub(super) fn save(&self, world: &mut World) -> Result<String, SceneError> {
        let keys = members(world);
        let key_of = |entity: Entity| keys.iter().find(|(_, member)| *member == entity).map(|&(key, _)| key);
        let body_of = |particle: &Entity| world.get::<InRig>(*particle).and_then(|rig| key_of(rig.body));
        let entities = self.entities.iter().map(|(name, named)| {
            let keys = match named {
                NamedEntity::Body { body, pieces } => match key_of(*body) {
                    Some(body) => {
                        [Some(body)].into_iter().chain(pieces.iter().copied().map(key_of)).collect()
                    }
                    None => Vec::new(),
                },
                NamedEntity::Obstacle(entity) => vec![key_of(*entity)],
                NamedEntity::Wind(_) => Vec::new(),
                NamedEntity::Rig { particles, .. } => particles.iter().map(body_of).collect(),
                NamedEntity::Balls(balls) | NamedEntity::Cannon { balls, .. } => {
                    balls.iter().copied().map(key_of).collect()
                }
            };
            (name.clone(), keys)
        });
        text::write(&SavedPlay {
            script: self.script.clone(),
            meshes: self.script.meshes.clone(),
            entities: entities.collect(),
            schedule: self.schedule.clone(),
            evaluators: self.evaluators.clone(),
            counted: self.counter.save(key_of),
            commands: self.commands.clone(),
            drags: self.drags.clone(),
            problems: self.problems.clone(),
            notes: self.notes.texts.clone(),
            paused_for: self.paused_for,
            steps: self.steps,
            began: self.began,
            is_stopping: self.is_stopping,
            is_over: self.is_over,
        })
    }
}

impl Checkpoint {
    /// Begins the scripted scene of this checkpoint in `world`, in place of the one that is being played, and takes it to
    /// where it was. It continues with the same bits, as if it had never stopped.
    ///
    /// # Errors
    /// [`CheckpointError`] if it was [taken](Self::take) of a world and not by a scene's timeline, or contradicts itself.
    pub fn resume(&self, world: &mut World) -> Result<(), CheckpointError> {
        let play = self.play().ok_or(CheckpointError::NoPlay)?;
        let mut saved: SavedPlay = text::parse(play, &SCHEMA).map_err(CheckpointError::BadPlay)?;
        saved.script.meshes = core::mem::take(&mut saved.meshes);
        respawn(world, &saved);
        self.restore(world)?;
        let keys = members(world);
        let entity_of =
            |key: Key| keys.binary_search_by_key(&key, |&(key, _)| key).ok().map(|index| keys[index].1);
        let counter = EventCounter::restored(world, &saved.counted, entity_of);
        let mut play = world.resource_mut::<ScenePlay>();
        *play = ScenePlay {
            entities: restored_entities(&play.entities, &saved, entity_of),
            script: saved.script,
            schedule: saved.schedule,
            evaluators: saved.evaluators,
            counter,
            commands: saved.commands,
            drags: saved.drags,
            problems: saved.problems,
            notes: Notes::from(saved.notes),
            paused_for: saved.paused_for,
            steps: saved.steps,
            began: saved.began,
            is_stopping: saved.is_stopping,
            is_over: saved.is_over,
        };
        Ok(())
    }
}

/// Begins the saved scene and spawns its bodies and obstacles one by one, each under the number that it had.
fn respawn(world: &mut World, saved: &SavedPlay) {
    let mut empty = SceneScript { timeline: Vec::new(), expectations: Vec::new(), ..saved.script.clone() };
    (empty.bodies, empty.obstacles) = (Named::default(), Named::default());
    empty.winds.retain(|name, _| saved.entities.contains_key(name));
    empty.winds.values_mut().for_each(|zone| zone.present = true);
    begin_scene(world, empty);
    world.resource_mut::<ScenePlay>().script = saved.script.clone();
    // Even a scene without bodies and obstacles needs a step: a world takes no snapshot before its first.
    take_step(world);
    for (name, number) in numbered(saved) {
        number_from(world, number - 1);
        world.resource_scope(|world, mut play: Mut<ScenePlay>| play.spawn(world, name));
        take_step(world);
    }
}

/// The entities of the saved play: `spawned` has bodies, obstacles and cannons, the snapshot has brought back the balls.
fn restored_entities(
    spawned: &SceneEntities,
    saved: &SavedPlay,
    entity_of: impl Fn(Key) -> Option<Entity>,
) -> SceneEntities {
    let of_keys = |keys: &[Option<Key>]| {
        let gone = Entity::PLACEHOLDER;
        keys.iter().map(|key| key.and_then(&entity_of).unwrap_or(gone)).collect::<Vec<_>>()
    };
    let restored = saved.entities.iter().map(|(name, keys)| {
        let named = match spawned.get(name) {
            Some(NamedEntity::Cannon { cannon, .. }) => {
                NamedEntity::Cannon { cannon: *cannon, balls: of_keys(keys) }
            }
            Some(NamedEntity::Body { body, .. }) => {
                NamedEntity::Body { body: *body, pieces: of_keys(keys.get(1..).unwrap_or_default()) }
            }
            Some(NamedEntity::Balls(_)) | None => NamedEntity::Balls(of_keys(keys)),
            Some(other) => other.clone(),
        };
        (name.clone(), named)
    });
    SceneEntities::from(restored.collect::<BTreeMap<_, _>>())
}

/// Takes a step outside of the fixed loop, so that no event happens.
fn take_step(world: &mut World) {
    let mut fixed = *world.resource::<Time<Fixed>>();
    fixed.advance_by(fixed.timestep());
    let usual = core::mem::replace(&mut *world.resource_mut::<Time>(), fixed.as_generic());
    world.run_schedule(FixedPostUpdate);
    *world.resource_mut::<Time>() = usual;
}

/// The names and numbers of the saved bodies and obstacles, in the order of their numbers.
fn numbered(saved: &SavedPlay) -> Vec<(&String, u64)> {
    let number = |key: &Key| match *key {
        Key::Body(number) | Key::Obstacle(number) if number > 0 => Some(number),
        _ => None,
    };
    let least = |keys: &[Option<Key>]| keys.iter().flatten().filter_map(number).min();
    let mut numbered: Vec<(&String, u64)> =
        saved.entities.iter().filter_map(|(name, keys)| Some((name, least(keys)?))).collect();
    numbered.sort_by_key(|&(_, number)| number);
    numbered
}
