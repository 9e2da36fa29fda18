//! Playing a scene in a Bevy app: it is spawned, its timeline runs, and its expectations are looked at.
//!
//! ```text
//! FixedUpdate                  events that are due, keyframes, drags
//!     (FixedPostUpdate)        DrapeSchedule takes a step; what bodies are asked to do before they are built is done there
//! FixedLast                    hits are counted, expectations and triggers looked at; after the last step the scene is over
//! ```

mod apply;
mod director;
mod drag;
mod judge;
mod measure;
mod notes;
mod orders;
mod points;
mod stage;
mod state;
mod tally;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use serde::{Deserialize, Serialize};

use crate::checkpoint::Checkpoint;
use crate::scene::SceneScript;
use drag::DragUnderWay;
use judge::Judge;
use notes::CutUnderWay;
use orders::Order;
use stage::Stage;
use tally::Tally;

pub use judge::Verdict;
pub(crate) use state::resume;

/// Plays scripted scenes in an app that has [`DrapePlugins`] in their usual schedule. A scene begins with [`begin_scene`].
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<PictureDue>()
            .add_message::<CheckpointTaken>()
            .add_systems(FixedUpdate, director::before_step)
            .add_systems(DrapeSchedule, orders::on_built_bodies.in_set(DrapeSystems::AccumulateForces))
            .add_systems(FixedLast, director::after_step);
    }
}

/// Sent when the timeline asks for a picture.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct PictureDue {
    /// Name of the scene's camera that takes it.
    pub camera: String,
}

/// Sent when the timeline asks for the state to be saved: that before the step that is about to be taken.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct CheckpointTaken {
    /// The name of the checkpoint.
    pub name: String,
    /// The state, with that of the timeline and the expectations.
    pub checkpoint: Checkpoint,
}

/// The scene that is being played.
#[derive(Resource)]
pub struct ScenePlay {
    /// The scene as it is now: `Set` changes it.
    script: SceneScript,
    stage: Stage,
    schedule: Vec<ScheduledEvent>,
    judges: Vec<Judge>,
    tally: Tally,
    orders: Vec<Order>,
    drags: Vec<DragUnderWay>,
    /// What went wrong, in words.
    problems: Vec<String>,
    /// What was asked for in vain, in words.
    notes: Vec<String>,
    /// Cuts of the step that is about to be taken.
    cuts: Vec<CutUnderWay>,
    /// Fixed ticks for which the scene still stands still.
    paused_for: u64,
    steps: u64,
    /// The clock's steps and time when the scene began.
    began: (u64, f64),
    /// Whether the step that is about to be taken is the last.
    is_stopping: bool,
    is_over: bool,
}

/// When an event happens next.
#[derive(Clone, Serialize, Deserialize)]
struct ScheduledEvent {
    /// In seconds; none while its trigger has not been set off, and once it is through.
    due: Option<f64>,
    /// Whether a trigger may still set it off.
    is_waiting: bool,
    /// How often it has happened.
    done: u32,
}

impl ScenePlay {
    /// The scene, as events have made it.
    pub fn script(&self) -> &SceneScript {
        &self.script
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Whether the last step has been taken.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// What was refused or could not be done, in words.
    pub fn problems(&self) -> &[String] {
        &self.problems
    }

    /// Everything of the scene that has positions, in the order of names: cloths, ropes and rigs with
    /// [`Particles`], and balls with a [`ProjectileState`].
    pub fn bodies(&self, world: &World) -> Vec<(String, Entity)> {
        self.stage.moving(world)
    }

    /// The entities that `name` stands for: of a rig its particles, of balls all of them.
    pub fn entities(&self, name: &str) -> Vec<Entity> {
        self.stage.entities(name)
    }

    /// What has become of the expectations so far.
    pub fn verdicts(&self) -> Vec<Verdict> {
        self.judges.iter().map(Judge::verdict).collect()
    }

    /// The indices of the expectations that have failed, whatever comes; once the scene is over, of all that do not hold.
    pub fn broken(&self) -> impl Iterator<Item = usize> {
        let is_broken = |judge: &Judge| judge.is_broken() || self.is_over && !judge.verdict().passed;
        self.judges.iter().enumerate().filter(move |(_, judge)| is_broken(judge)).map(|(index, _)| index)
    }

    /// The end of the last step in seconds since the scene began.
    fn time(&self, world: &World) -> f64 {
        world.resource::<DrapeClock>().elapsed() - self.began.1
    }
}

/// Begins `script`, in place of the scene that is being played, if there is one.
pub fn begin_scene(world: &mut World, script: SceneScript) {
    end_scene(world);
    apply::settings(world, &script.settings);
    let schedule = script
        .timeline
        .iter()
        .map(|event| ScheduledEvent {
            due: event.at.map(crate::scene::Seconds::get),
            is_waiting: event.when.is_some(),
            done: 0,
        })
        .collect();
    let judges = script.expectations.iter().cloned().map(Judge::new).collect();
    let clock = world.resource::<DrapeClock>();
    let began = (clock.steps(), clock.elapsed());
    let mut play = ScenePlay {
        stage: Stage::default(),
        schedule,
        judges,
        tally: Tally::new(world),
        orders: Vec::new(),
        drags: Vec::new(),
        problems: Vec::new(),
        notes: Vec::new(),
        cuts: Vec::new(),
        paused_for: 0,
        steps: 0,
        began,
        is_stopping: false,
        is_over: false,
        script,
    };
    let present = play.script.clone();
    for (name, obstacle) in present.obstacles.iter().filter(|(_, obstacle)| obstacle.present) {
        play.spawn_obstacle(world, name, obstacle);
    }
    for (name, zone) in present.winds.iter().filter(|(_, zone)| zone.present) {
        play.spawn_wind(world, name, zone);
    }
    for (name, body) in present.bodies.iter().filter(|(_, body)| body.is_present()) {
        play.spawn_body(world, name, body);
    }
    for (name, cannon) in present.cannons.iter() {
        play.spawn_cannon(world, name, cannon);
    }
    world.insert_resource(play);
}

/// Despawns the scene that is being played, if there is one.
pub fn end_scene(world: &mut World) {
    if let Some(mut play) = world.remove_resource::<ScenePlay>() {
        play.stage.clear(world);
        if play.paused_for > 0 {
            world.resource_mut::<DrapeClock>().paused = false;
        }
    }
}
