//! The systems that run before and after each step.

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use super::measure::measure;
use super::scene_play::ScenePlay;
use crate::scene::{Action, Motion};

/// Carries out events that are due, and moves keyframed obstacles and drags.
pub(super) fn before_step(world: &mut World) {
    world.try_resource_scope(|world, mut play: Mut<ScenePlay>| play.before_step(world));
}

/// Carries out the commands to bodies that have just been built.
pub(super) fn command_built_bodies(world: &mut World) {
    world.try_resource_scope(|world, mut play: Mut<ScenePlay>| {
        if !play.commands.is_empty() {
            play.carry_out_commands(world);
        }
    });
}

/// Counts hits, evaluates expectations and triggers, and ends the scene.
pub(super) fn after_step(world: &mut World) {
    world.try_resource_scope(|world, mut play: Mut<ScenePlay>| {
        let steps = world.resource::<DrapeClock>().steps() - play.began.0;
        if steps > play.steps && !play.is_over {
            play.steps = steps;
            play.after_step(world);
        }
    });
}

impl ScenePlay {
    fn before_step(&mut self, world: &mut World) {
        if self.is_over {
            return;
        }
        if self.paused_for > 0 {
            self.paused_for -= 1;
            if self.paused_for > 0 {
                return;
            }
            world.resource_mut::<DrapeClock>().paused = false;
        }
        let time = self.time(world);
        let dt = self.script.settings.dt.get();
        // Half a step of slack, as the clock sums up rounded steps.
        let now = time + 0.5 * dt;
        self.carry_out_events(world, time, now, |_| true);
        self.move_obstacles(world, time + dt);
        self.drags.retain_mut(|drag| drag.advance(world, &self.entities, time + dt));
        self.carry_out_commands(world);
    }

    /// Carries out the commands whose bodies have been built; the others wait.
    fn carry_out_commands(&mut self, world: &mut World) {
        self.commands.retain(|command| !command.carry_out(world, &self.script, &self.entities));
    }

    /// Moves obstacles to where they are at `time`, the end of the step.
    fn move_obstacles(&self, world: &mut World, time: f64) {
        for (name, entity) in self.entities.obstacles() {
            let Some(obstacle) = self.script.obstacles.get(name) else { continue };
            if matches!(obstacle.motion, Motion::Static | Motion::Dynamic(_)) {
                continue;
            }
            if let Some((translation, rotation)) = obstacle.place_at(time)
                && let Some(mut transform) = world.get_mut::<Transform>(entity)
            {
                transform.set_if_neq(Transform { translation, rotation, scale: transform.scale });
            }
        }
    }

    fn after_step(&mut self, world: &mut World) {
        self.counter.read(world, &mut self.entities);
        self.notes.add_vain_cuts(&self.counter);
        for problem in world.resource::<Refusals>().iter().map(ToString::to_string) {
            if !self.problems.contains(&problem) {
                self.problems.push(problem);
            }
        }
        let time = self.time(world);
        let slack = 0.5 * self.script.settings.dt.get();
        self.is_over = self.is_stopping || time >= self.script.settings.duration.get() - slack;
        for evaluator in &mut self.evaluators {
            evaluator.step(time, slack, self.is_over, |probe| {
                measure(world, &self.entities, &self.counter, probe)
            });
        }
        self.fire_triggers(world, time);
        if self.is_over {
            // No step follows before which they could be carried out.
            let is_of_the_end =
                |action: &Action| matches!(action, Action::Picture(_) | Action::Checkpoint(_));
            self.carry_out_events(world, time, time + slack, is_of_the_end);
        }
    }

    /// Schedules the events whose triggers fire.
    fn fire_triggers(&mut self, world: &World, time: f64) {
        for (event, scheduled) in self.script.timeline.iter().zip(&mut self.schedule) {
            let Some(trigger) = event.when.as_ref().filter(|_| scheduled.is_waiting) else { continue };
            let (probe, expect) = trigger.as_probe();
            let measured = measure(world, &self.entities, &self.counter, &probe);
            if measured.is_some_and(|measured| expect.excess(&measured) <= 0.0) {
                (scheduled.is_waiting, scheduled.due) = (false, Some(time));
            }
        }
    }
}
