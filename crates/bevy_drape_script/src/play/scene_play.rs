//! The state of a scene that is being played.

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;

use super::command::BodyCommand;
use super::drag::Drag;
use super::event_counter::EventCounter;
use super::expectation_evaluator::ExpectationEvaluator;
use super::measure;
use super::notes::Notes;
use super::scene_entities::SceneEntities;
use super::scheduled_event::ScheduledEvent;
use super::verdict::Verdict;
use crate::scene::SceneScript;

/// The scene that is being played.
#[derive(Resource)]
pub struct ScenePlay {
    /// The scene as it is now: `Set` changes it.
    pub(super) script: SceneScript,
    pub(super) entities: SceneEntities,
    pub(super) schedule: Vec<ScheduledEvent>,
    pub(super) evaluators: Vec<ExpectationEvaluator>,
    pub(super) counter: EventCounter,
    /// Commands to bodies that have not been built yet.
    pub(super) commands: Vec<BodyCommand>,
    pub(super) drags: Vec<Drag>,
    /// Failures, in words.
    pub(super) problems: Vec<String>,
    pub(super) notes: Notes,
    /// The number of fixed ticks for which the scene is still paused.
    pub(super) paused_for: u64,
    pub(super) steps: u64,
    /// Steps and time in seconds of the clock when the scene began.
    pub(super) began: (u64, f64),
    /// True if the next step is the last.
    pub(super) is_stopping: bool,
    pub(super) is_over: bool,
}

impl ScenePlay {
    /// A play of `script` that begins now. Nothing is spawned yet.
    pub(super) fn new(world: &World, script: SceneScript) -> Self {
        let clock = world.resource::<DrapeClock>();
        Self {
            entities: SceneEntities::default(),
            schedule: script.timeline.iter().map(ScheduledEvent::from).collect(),
            evaluators: script.expectations.iter().cloned().map(ExpectationEvaluator::new).collect(),
            counter: EventCounter::new(world),
            commands: Vec::new(),
            drags: Vec::new(),
            problems: Vec::new(),
            notes: Notes::default(),
            paused_for: 0,
            steps: 0,
            began: (clock.steps(), clock.elapsed()),
            is_stopping: false,
            is_over: false,
            script,
        }
    }

    /// The scene, as events have changed it.
    pub fn script(&self) -> &SceneScript {
        &self.script
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Returns true once the last step has been taken.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Everything that the plugin refused or that could not be done, in words.
    pub fn problems(&self) -> &[String] {
        &self.problems
    }

    /// Actions that had no effect, in words; once the scene is over, also events that never happened.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.notes.texts.clone();
        if !self.is_over {
            return notes;
        }
        for (index, event) in self.schedule.iter().enumerate().filter(|(_, event)| event.done == 0) {
            if event.is_waiting {
                notes.push(format!("timeline[{index}]: it was never set off"));
            } else if event.due.is_some() {
                notes.push(format!("timeline[{index}]: the scene was over before"));
            }
        }
        let waiting = self.commands.iter().map(|command| &command.of);
        notes.extend(waiting.map(|of| format!("`{of}` never came to be pinned, let go or pushed")));
        notes
    }

    /// All entities of the scene that have positions, in the order of their names: cloths, ropes and rigs with
    /// [`Particles`](bevy_drape::body::Particles), and balls with a
    /// [`ProjectileState`](bevy_drape::ball::ProjectileState).
    pub fn bodies(&self, world: &World) -> Vec<(String, Entity)> {
        self.entities.moving(world)
    }

    /// The entities that `name` stands for: of a rig its particles, of balls all of them.
    pub fn entities(&self, name: &str) -> Vec<Entity> {
        self.entities.entities(name)
    }

    /// Hash of the state of everything that moves by itself.
    pub fn state_hash(&self, world: &World) -> u64 {
        measure::hash_of_all(world, &self.entities)
    }

    /// The results of the expectations so far.
    pub fn verdicts(&self) -> Vec<Verdict> {
        self.evaluators.iter().map(ExpectationEvaluator::verdict).collect()
    }

    /// The indices of the expectations that have failed, whatever comes; once the scene is over, of all that do not hold.
    pub fn broken(&self) -> impl Iterator<Item = usize> {
        let is_broken = |evaluator: &ExpectationEvaluator| {
            evaluator.is_broken() || self.is_over && !evaluator.verdict().passed
        };
        let all = self.evaluators.iter().enumerate();
        all.filter(move |(_, evaluator)| is_broken(evaluator)).map(|(index, _)| index)
    }

    /// The end of the last step in seconds since the scene began.
    pub(super) fn time(&self, world: &World) -> f64 {
        world.resource::<DrapeClock>().elapsed() - self.began.1
    }
}
