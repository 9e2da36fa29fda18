//! The director: what happens before and after each step.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::drag::DragUnderWay;
use super::orders::{Order, OrderKind};
use super::stage::Actor;
use super::{CheckpointTaken, PictureDue, ScenePlay};
use crate::checkpoint::Checkpoint;
use crate::overriding;
use crate::scene::{Action, Measured, Motion, Seconds, Selection};

/// Events that are due, keyframes and drags.
pub(super) fn before_step(world: &mut World) {
    world.try_resource_scope(|world, mut play: Mut<ScenePlay>| play.before_step(world));
}

/// Hits, expectations, triggers, the end.
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
        // Half a step of slack: the clock sums up rounded steps.
        let now = time + 0.5 * dt;
        self.carry_out_events(world, time, now, |_| true);
        self.move_obstacles(world, time + dt);
        self.drag(world, time + dt);
        self.carry_out_orders(world);
    }

    /// Does what is due by `now`, of what is `wanted`.
    fn carry_out_events(&mut self, world: &mut World, time: f64, now: f64, wanted: fn(&Action) -> bool) {
        self.save_state(world, now);
        for index in 0..self.schedule.len() {
            while let Some(due) = self.schedule[index].due.filter(|&due| due <= now) {
                let event = &self.script.timeline[index];
                if !wanted(&event.action) {
                    break;
                }
                let action = event.action.clone();
                let scheduled = &mut self.schedule[index];
                scheduled.done += 1;
                let repeat = event.repeat.filter(|repeat| scheduled.done < repeat.times.get());
                scheduled.due = repeat.map(|repeat| due + f64::from(repeat.every.get()));
                self.note_event(index, time);
                self.act(world, &action, time);
            }
        }
    }

    /// Takes the checkpoints that are due by `now`.
    fn save_state(&mut self, world: &mut World, now: f64) {
        for (event, scheduled) in self.script.timeline.iter().zip(&self.schedule) {
            if let Action::Checkpoint(name) = &event.action
                && scheduled.due.is_some_and(|due| due <= now)
            {
                match self.save(world) {
                    Ok(play) => {
                        let checkpoint = Checkpoint::of(world, name, Some(play));
                        world.write_message(CheckpointTaken { name: name.clone(), checkpoint });
                    }
                    Err(error) => self.problems.push(format!("checkpoint {name}: {error}")),
                }
            }
        }
    }

    fn act(&mut self, world: &mut World, action: &Action, time: f64) {
        let mut order = |of: &str, particles: &Selection, kind: OrderKind| {
            self.orders.push(Order { of: of.to_string(), particles: particles.clone(), kind });
        };
        match action {
            Action::Fire(name) => {
                if let Some(&Actor::Cannon { cannon, .. }) = self.stage.get(name) {
                    world.write_message(FireCannon { cannon });
                }
            }
            Action::Aim { cannon, aim, speed } => {
                let mut script = self.script.clone();
                if let Some(cannon) = script.cannons.get_mut(cannon) {
                    cannon.aim = aim.clone();
                    cannon.speed = speed.unwrap_or(cannon.speed);
                }
                self.change(world, script);
            }
            Action::SetWind(velocity) => {
                let mut script = self.script.clone();
                script.settings.wind.velocity = *velocity;
                self.change(world, script);
            }
            Action::Pin { of, particles } => order(of, particles, OrderKind::Pin),
            Action::Unpin { of, particles } => order(of, particles, OrderKind::Unpin),
            Action::Push { of, impulse, particles } => order(of, particles, OrderKind::Push(*impulse)),
            drag @ Action::Drag { .. } => {
                let hand = DragUnderWay::free_hand(&self.drags);
                self.drags.extend(DragUnderWay::new(drag, time, hand));
            }
            Action::Cut { of, from, to } => {
                let sweep = CutCloth::sweep([from.0.get(), from.1.get()], [to.0.get(), to.1.get()]);
                if of.is_empty() {
                    world.write_message(sweep.clone());
                }
                for entity in of.iter().flat_map(|name| self.stage.entities(name)) {
                    world.write_message(sweep.clone().only(entity));
                }
            }
            Action::Set(path, value) => match overriding::replaced(&self.script, path, value) {
                Ok(script) => self.change(world, script),
                Err(error) => self.problems.push(error.to_string()),
            },
            Action::Spawn(name) => self.spawn(world, name),
            Action::Despawn(name) => self.stage.exit(world, name),
            Action::Pause(seconds) => self.pause(world, *seconds),
            Action::Picture(camera) => {
                world.write_message(PictureDue { camera: camera.clone() });
            }
            // Before all that is due with it, so that nothing is half done.
            Action::Checkpoint(_) => {}
            Action::Stop => self.is_stopping = true,
        }
    }

    pub(super) fn spawn(&mut self, world: &mut World, name: &str) {
        if self.stage.contains(name) {
            return;
        }
        let script = &self.script;
        if let Some(body) = script.bodies.get(name).cloned() {
            self.spawn_body(world, name, &body);
        } else if let Some(obstacle) = script.obstacles.get(name).cloned() {
            self.spawn_obstacle(world, name, &obstacle);
        } else if let Some(zone) = script.winds.get(name).cloned() {
            self.spawn_wind(world, name, &zone);
        } else if let Some(cannon) = script.cannons.get(name).cloned() {
            self.spawn_cannon(world, name, &cannon);
        }
    }

    fn pause(&mut self, world: &mut World, seconds: Seconds) {
        let ticks = (seconds.get() / self.script.settings.dt.get()).round();
        if ticks >= 1.0 {
            self.paused_for = ticks as u64;
            world.resource_mut::<DrapeClock>().paused = true;
        }
    }

    /// Puts obstacles where they are at the end of the step, at `time`.
    fn move_obstacles(&self, world: &mut World, time: f64) {
        for (name, entity) in self.stage.obstacles() {
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
        self.tally.read(world, &mut self.stage);
        self.note_cuts();
        for message in world.resource::<Refusals>().messages() {
            if !self.problems.iter().any(|known| known == message) {
                self.problems.push(message.to_string());
            }
        }
        let time = self.time(world);
        let slack = 0.5 * self.script.settings.dt.get();
        self.is_over = self.is_stopping || time >= self.script.settings.duration.get() - slack;
        let mut judges = core::mem::take(&mut self.judges);
        for judge in &mut judges {
            let base_is_due =
                judge.base.is_none() && judge.since().is_some_and(|since| time >= since - slack);
            // What counts from a base says nothing before that is known.
            let has_base = judge.since().is_none() || judge.base.is_some() || base_is_due;
            let looks = has_base && judge.looks_at(time, slack, self.is_over);
            if !looks && !base_is_due {
                continue;
            }
            let Some(mut measured) = self.measure(world, &judge.expectation.probe) else { continue };
            if let Measured::Number(number) = &mut measured {
                if base_is_due {
                    judge.base = Some(*number);
                }
                *number -= judge.base.unwrap_or(0.0);
            }
            if looks {
                judge.look(time, measured);
            }
        }
        self.judges = judges;
        for index in 0..self.schedule.len() {
            if !self.schedule[index].is_waiting {
                continue;
            }
            let Some(trigger) = &self.script.timeline[index].when else { continue };
            let (probe, expect) = trigger.as_probe();
            if self.measure(world, &probe).is_some_and(|measured| expect.excess(&measured) <= 0.0) {
                let scheduled = &mut self.schedule[index];
                (scheduled.is_waiting, scheduled.due) = (false, Some(time));
            }
        }
        if self.is_over {
            // There is no step before which it could be done.
            let is_of_the_end =
                |action: &Action| matches!(action, Action::Picture(_) | Action::Checkpoint(_));
            self.carry_out_events(world, time, time + slack, is_of_the_end);
        }
    }
}
