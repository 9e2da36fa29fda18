//! Carries out the events of the timeline.

use bevy::prelude::*;
use bevy_drape::cannon::FireCannon;
use bevy_drape::clock::DrapeClock;
use bevy_drape::tear::CutCloth;

use super::command::{BodyCommand, CommandKind};
use super::drag::Drag;
use super::messages::{CheckpointTaken, PictureDue};
use super::named_entity::NamedEntity;
use super::scene_play::ScenePlay;
use crate::checkpoint::Checkpoint;
use crate::load::replaced;
use crate::scene::{Action, Seconds, Selection};

impl ScenePlay {
    /// Carries out the `wanted` events that are due by `now`.
    pub(super) fn carry_out_events(
        &mut self,
        world: &mut World,
        time: f64,
        now: f64,
        wanted: fn(&Action) -> bool,
    ) {
        self.take_checkpoints(world, now);
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
                self.notes.add_event(index, &action, time, &self.entities, &self.counter);
                self.carry_out(world, &action, time);
            }
        }
    }

    /// Takes the checkpoints that are due by `now`.
    fn take_checkpoints(&mut self, world: &mut World, now: f64) {
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

    fn carry_out(&mut self, world: &mut World, action: &Action, time: f64) {
        let mut command = |of: &str, particles: &Selection, kind: CommandKind| {
            self.commands.push(BodyCommand { of: of.to_string(), particles: particles.clone(), kind });
        };
        match action {
            Action::Fire(name) => {
                if let Some(&NamedEntity::Cannon { cannon, .. }) = self.entities.get(name) {
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
            Action::Pin { of, particles } => command(of, particles, CommandKind::Pin),
            Action::Unpin { of, particles } => command(of, particles, CommandKind::Unpin),
            Action::Push { of, impulse, particles } => command(of, particles, CommandKind::Push(*impulse)),
            drag @ Action::Drag { .. } => {
                let hand = Drag::free_hand(&self.drags);
                self.drags.extend(Drag::new(drag, time, hand));
            }
            Action::Cut { of, from, to } => {
                let sweep = CutCloth::sweep([from.0.get(), from.1.get()], [to.0.get(), to.1.get()]);
                if of.is_empty() {
                    world.write_message(sweep.clone());
                }
                for entity in of.iter().flat_map(|name| self.entities.entities(name)) {
                    world.write_message(sweep.clone().only(entity));
                }
            }
            Action::Set(path, value) => match replaced(&self.script, path, value) {
                Ok(script) => self.change(world, script),
                Err(error) => self.problems.push(error.to_string()),
            },
            Action::Spawn(name) => self.spawn(world, name),
            Action::Despawn(name) => self.entities.despawn(world, name),
            Action::Pause(seconds) => self.pause(world, *seconds),
            Action::Picture(camera) => {
                world.write_message(PictureDue { camera: camera.clone() });
            }
            // Taken before all other events of this time, so that none is half done.
            Action::Checkpoint(_) => {}
            Action::Stop => self.is_stopping = true,
        }
    }

    /// Spawns what is called `name`, unless it exists.
    pub(super) fn spawn(&mut self, world: &mut World, name: &str) {
        if self.entities.contains(name) {
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
}
