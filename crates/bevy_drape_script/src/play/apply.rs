//! A scene that changes while it is played: what is different is brought into the world.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::ScenePlay;
use super::stage::{Actor, mark, place, set_tearable};
use crate::scene::{self, Body, SceneScript, Settings};

/// Gravity, wind, the length of a step and so on.
pub(super) fn settings(world: &mut World, settings: &Settings) {
    world.insert_resource(Time::<Fixed>::from(settings));
    world.insert_resource(DrapeGravity::from(settings));
    world.insert_resource(Wind::from(&settings.wind));
    world.insert_resource(DefaultSolverSettings(settings.solver.over(SolverSettings::default())));
    world.resource_mut::<SceneManager>().sleeping = settings.sleeping;
}

impl ScenePlay {
    /// Makes `script` the scene that is played: what is on the stage and told differently there is changed.
    pub(super) fn change(&mut self, world: &mut World, script: SceneScript) {
        let old = core::mem::replace(&mut self.script, script.clone());
        if old.settings != script.settings {
            self.change_settings(world, &old.settings, &script.settings);
        }
        for (name, body) in script.bodies.iter() {
            if let Some(actor) = self.stage.get(name).cloned() {
                self.change_body(world, name, &actor, old.bodies.get(name), body);
            }
        }
        for (name, obstacle) in script.obstacles.iter() {
            if old.obstacles.get(name) != Some(obstacle)
                && let Some(&Actor::Obstacle(entity)) = self.stage.get(name)
                && let Some(component) = self.obstacle_component(name, obstacle)
            {
                world.entity_mut(entity).insert(component);
                mark(world, entity, name, obstacle.layers.as_ref(), obstacle.contacts);
                let was = old.obstacles.get(name);
                if was.is_some_and(|was| (was.at, was.turn) != (obstacle.at, obstacle.turn)) {
                    world.entity_mut(entity).insert(place(obstacle.at, &obstacle.turn));
                }
            }
        }
        for (name, zone) in script.winds.iter() {
            if old.winds.get(name) != Some(zone)
                && let Some(&Actor::Wind(entity)) = self.stage.get(name)
            {
                world.entity_mut(entity).insert((WindZone::from(zone), zone.place()));
            }
        }
        for (name, cannon) in script.cannons.iter() {
            if old.cannons.get(name) != Some(cannon)
                && let Some(&Actor::Cannon { cannon: entity, .. }) = self.stage.get(name)
            {
                world.entity_mut(entity).insert(cannon.component(script.settings.gravity));
            }
        }
    }

    fn change_settings(&self, world: &mut World, old: &Settings, new: &Settings) {
        if old.gravity != new.gravity {
            world.insert_resource(DrapeGravity::from(new));
        }
        if old.wind != new.wind {
            world.insert_resource(Wind::from(&new.wind));
        }
        if old.dt != new.dt {
            world.resource_mut::<Time<Fixed>>().set_timestep_seconds(new.dt.get());
        }
        world.resource_mut::<DefaultSolverSettings>().0 = new.solver.over(SolverSettings::default());
        world.resource_mut::<SceneManager>().sleeping = new.sleeping;
    }

    fn change_body(&mut self, world: &mut World, name: &str, actor: &Actor, old: Option<&Body>, new: &Body) {
        let settings = self.solver_settings(new.solver().unwrap_or(&scene::Solver::default()));
        let is_changed = old != Some(new);
        match (actor, new, old) {
            (&Actor::Body { body, .. }, Body::Cloth(cloth), Some(Body::Cloth(was))) => {
                insert_if_other(world, body, settings);
                if is_changed {
                    let has_moved = (cloth.at, cloth.turn) != (was.at, was.turn);
                    let place = has_moved.then(|| place(cloth.at, &cloth.turn));
                    self.describe_anew(world, name, new, [was, cloth].map(Cloth::from), place);
                    mark(world, body, name, cloth.layers.as_ref(), cloth.contacts);
                }
            }
            (&Actor::Body { body, .. }, Body::Rope(rope), Some(Body::Rope(was))) => {
                insert_if_other(world, body, settings);
                if is_changed {
                    self.describe_anew(world, name, new, [was, rope].map(Rope::from), None);
                    mark(world, body, name, rope.layers.as_ref(), rope.contacts);
                }
            }
            (&Actor::Body { body, .. }, Body::SoftBall(ball), Some(Body::SoftBall(was))) => {
                insert_if_other(world, body, settings);
                if is_changed {
                    let has_moved = (ball.at, ball.turn) != (was.at, was.turn);
                    let place = has_moved.then(|| place(ball.at, &ball.turn));
                    self.describe_anew(world, name, new, [was, ball].map(SoftBall::from), place);
                    mark(world, body, name, ball.layers.as_ref(), ball.contacts);
                }
            }
            (Actor::Rig { particles, .. }, Body::Rig(rig), Some(Body::Rig(was))) => {
                let is_only_solver = scene::Rig { solver: was.solver.clone(), ..rig.clone() } == *was;
                if is_only_solver {
                    for &particle in particles {
                        insert_if_other(world, particle, settings);
                    }
                } else {
                    self.stage.exit(world, name);
                    self.spawn_body(world, name, new);
                }
            }
            _ if is_changed => {
                self.stage.exit(world, name);
                self.spawn_body(world, name, new);
            }
            _ => {}
        }
    }

    /// Brings what differs between two descriptions of a body to its entity. A body that is built anew has no pieces.
    fn describe_anew<D: Component + PartialEq>(
        &mut self,
        world: &mut World,
        name: &str,
        body: &Body,
        [was, is]: [D; 2],
        place: Option<Transform>,
    ) {
        let entities = self.stage.entities(name);
        for &entity in &entities {
            set_tearable(world, entity, body);
        }
        let Some(&entity) = entities.first() else { return };
        if is != was {
            self.stage.drop_pieces(world, name);
            world.entity_mut(entity).insert(is);
        }
        if let Some(place) = place {
            world.entity_mut(entity).insert(place);
        }
    }
}

fn insert_if_other(world: &mut World, entity: Entity, settings: SolverSettings) {
    if world.get::<SolverSettings>(entity) != Some(&settings) {
        world.entity_mut(entity).insert(settings);
    }
}
