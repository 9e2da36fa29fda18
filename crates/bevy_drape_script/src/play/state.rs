//! The state of a scene that is being played, to be kept in a checkpoint and gone on from.

use std::collections::BTreeMap;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::{Key, Snapshot, members, number_from};
use serde::{Deserialize, Serialize};

use super::drag::DragUnderWay;
use super::judge::Judge;
use super::orders::Order;
use super::stage::Actor;
use super::tally::{Counted, Tally};
use super::{ScenePlay, ScheduledEvent, begin_scene};
use crate::SceneError;
use crate::checkpoint::CheckpointError;
use crate::mesh_file::MeshFiles;
use crate::scene::{Named, SceneScript};
use crate::text;

/// All that a scene remembers while it is played.
#[derive(Clone, Serialize, Deserialize)]
struct PlayState {
    script: SceneScript,
    /// What was read for it, as its files may be elsewhere when it goes on.
    meshes: MeshFiles,
    /// The keys of all who are on the stage, by name: of balls one each, as long as there is a ball.
    actors: BTreeMap<String, Vec<Option<Key>>>,
    schedule: Vec<ScheduledEvent>,
    judges: Vec<Judge>,
    counted: Counted,
    orders: Vec<Order>,
    drags: Vec<DragUnderWay>,
    problems: Vec<String>,
    notes: Vec<String>,
    paused_for: u64,
    steps: u64,
    began: (u64, f64),
    is_stopping: bool,
    is_over: bool,
}

impl ScenePlay {
    /// All that it remembers, as text.
    pub(super) fn save(&self, world: &mut World) -> Result<String, SceneError> {
        let keys = members(world);
        let key_of = |entity: Entity| keys.iter().find(|(_, member)| *member == entity).map(|&(key, _)| key);
        let body_of = |particle: &Entity| world.get::<InRig>(*particle).and_then(|rig| key_of(rig.body));
        let actors = self.stage.actors().map(|(name, actor)| {
            let keys = match actor {
                Actor::Body { body, .. } => vec![key_of(*body)],
                Actor::Obstacle(entity) => vec![key_of(*entity)],
                Actor::Wind(_) => Vec::new(),
                Actor::Rig { particles, .. } => particles.iter().map(body_of).collect(),
                Actor::Balls(balls) | Actor::Cannon { balls, .. } => {
                    balls.iter().copied().map(key_of).collect()
                }
            };
            (name.clone(), keys)
        });
        text::write(&PlayState {
            script: self.script.clone(),
            meshes: self.script.meshes.clone(),
            actors: actors.collect(),
            schedule: self.schedule.clone(),
            judges: self.judges.clone(),
            counted: self.tally.save(key_of),
            orders: self.orders.clone(),
            drags: self.drags.clone(),
            problems: self.problems.clone(),
            notes: self.notes.clone(),
            paused_for: self.paused_for,
            steps: self.steps,
            began: self.began,
            is_stopping: self.is_stopping,
            is_over: self.is_over,
        })
    }
}

/// Begins the scene whose state was kept, in place of the one that is being played, and takes it to where it was.
pub(crate) fn resume(
    world: &mut World,
    scene: &str,
    snapshot: &Snapshot,
    play: &str,
) -> Result<(), CheckpointError> {
    let mut state: PlayState = text::parse(play).map_err(CheckpointError::BadPlay)?;
    state.script.meshes = core::mem::take(&mut state.meshes);
    // Bodies and obstacles are spawned one by one, each under the number that it had.
    let mut empty = SceneScript { timeline: Vec::new(), expectations: Vec::new(), ..state.script.clone() };
    (empty.bodies, empty.obstacles) = (Named::default(), Named::default());
    empty.winds.retain(|name, _| state.actors.contains_key(name));
    empty.winds.values_mut().for_each(|zone| zone.present = true);
    begin_scene(world, empty);
    world.resource_mut::<ScenePlay>().script = state.script.clone();
    // A scene without bodies and obstacles too: a world takes no snapshot before its first step.
    take_step(world);
    for (name, number) in numbered(&state) {
        number_from(world, number - 1);
        world.resource_scope(|world, mut play: Mut<ScenePlay>| play.spawn(world, name));
        take_step(world);
    }
    snapshot
        .restore(world)
        .map_err(|source| CheckpointError::AnotherWorld { scene: scene.to_string(), source })?;
    let keys = members(world);
    let entity_of = |key: Key| keys.binary_search_by_key(&key, |&(key, _)| key).ok().map(|at| keys[at].1);
    let tally = Tally::restored(world, &state.counted, entity_of);
    world.resource_scope(|_, mut play: Mut<ScenePlay>| {
        let of_keys = |keys: &[Option<Key>]| {
            let gone = Entity::PLACEHOLDER;
            keys.iter().map(|key| key.and_then(entity_of).unwrap_or(gone)).collect::<Vec<_>>()
        };
        let cast = state.actors.iter().map(|(name, keys)| {
            let actor = match play.stage.get(name) {
                Some(Actor::Cannon { cannon, .. }) => Actor::Cannon { cannon: *cannon, balls: of_keys(keys) },
                Some(Actor::Balls(_)) | None => Actor::Balls(of_keys(keys)),
                Some(other) => other.clone(),
            };
            (name.clone(), actor)
        });
        let cast = cast.collect();
        play.stage.cast(cast);
        *play = ScenePlay {
            script: state.script,
            stage: core::mem::take(&mut play.stage),
            schedule: state.schedule,
            judges: state.judges,
            tally,
            orders: state.orders,
            drags: state.drags,
            problems: state.problems,
            notes: state.notes,
            cuts: Vec::new(),
            paused_for: state.paused_for,
            steps: state.steps,
            began: state.began,
            is_stopping: state.is_stopping,
            is_over: state.is_over,
        };
    });
    Ok(())
}

/// Takes a step outside of the fixed loop, so that nothing of the timeline happens.
fn take_step(world: &mut World) {
    let mut fixed = *world.resource::<Time<Fixed>>();
    fixed.advance_by(fixed.timestep());
    let usual = core::mem::replace(&mut *world.resource_mut::<Time>(), fixed.as_generic());
    world.run_schedule(FixedPostUpdate);
    *world.resource_mut::<Time>() = usual;
}

/// The bodies and obstacles that are there, and their numbers, in the order of these.
fn numbered(state: &PlayState) -> Vec<(&String, u64)> {
    let number = |key: &Key| match *key {
        Key::Body(number) | Key::Obstacle(number) if number > 0 => Some(number),
        _ => None,
    };
    let least = |keys: &[Option<Key>]| keys.iter().flatten().filter_map(number).min();
    let mut numbered: Vec<(&String, u64)> =
        state.actors.iter().filter_map(|(name, keys)| Some((name, least(keys)?))).collect();
    numbered.sort_by_key(|&(_, number)| number);
    numbered
}
