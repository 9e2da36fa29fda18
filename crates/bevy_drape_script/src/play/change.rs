//! Changes a scene while it is played: applies the differences to the world.

use bevy::prelude::*;
use bevy_drape::body::DefaultSolverSettings;
use bevy_drape::prelude::*;
use bevy_drape::sleep::SceneManager;

use super::components::{mark, place, set_dynamic, set_pressure, set_tearable, set_touch};
use super::named_entity::NamedEntity;
use super::scene_play::ScenePlay;
use crate::scene::{self, Body, SceneScript, Settings};

/// Applies gravity, wind, the length of a step and so on.
pub(super) fn apply_settings(world: &mut World, settings: &Settings) {
    world.insert_resource(Time::<Fixed>::from(settings));
    world.insert_resource(DrapeGravity::from(settings));
    world.insert_resource(Wind::from(&settings.wind));
    world.insert_resource(DefaultSolverSettings(settings.solver.over(SolverSettings::default())));
    world.resource_mut::<SceneManager>().sleeping = settings.sleeping;
}

impl ScenePlay {
    /// Makes `script` the scene that is played, and changes all entities that it describes differently.
    pub(super) fn change(&mut self, world: &mut World, script: SceneScript) {
        let old = core::mem::replace(&mut self.script, script.clone());
        if old.settings != script.settings {
            self.change_settings(world, &old.settings, &script.settings);
        }
        for (name, body) in script.bodies.iter() {
            if let Some(named) = self.entities.get(name).cloned() {
                self.change_body(world, name, &named, old.bodies.get(name), body);
            }
        }
        for (name, obstacle) in script.obstacles.iter() {
            if old.obstacles.get(name) != Some(obstacle)
                && let Some(&NamedEntity::Obstacle(entity)) = self.entities.get(name)
                && let Some(component) = self.obstacle_component(name, obstacle)
            {
                world.entity_mut(entity).insert(component);
                mark(world, entity, name, obstacle.layers.as_ref(), obstacle.contacts);
                let was = old.obstacles.get(name);
                if was.is_none_or(|was| (&was.motion, &was.shape) != (&obstacle.motion, &obstacle.shape)) {
                    set_dynamic(world, entity, obstacle);
                }
                if was.is_some_and(|was| (was.at, was.turn) != (obstacle.at, obstacle.turn)) {
                    world.entity_mut(entity).insert(place(obstacle.at, &obstacle.turn));
                }
            }
        }
        for (name, zone) in script.winds.iter() {
            if old.winds.get(name) != Some(zone)
                && let Some(&NamedEntity::Wind(entity)) = self.entities.get(name)
            {
                world.entity_mut(entity).insert((WindZone::from(zone), zone.place()));
            }
        }
        for (name, cannon) in script.cannons.iter() {
            if old.cannons.get(name) != Some(cannon)
                && let Some(&NamedEntity::Cannon { cannon: entity, .. }) = self.entities.get(name)
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

    fn change_body(
        &mut self,
        world: &mut World,
        name: &str,
        named: &NamedEntity,
        old: Option<&Body>,
        new: &Body,
    ) {
        let settings = self.solver_settings(new.solver().unwrap_or(&scene::Solver::default()));
        let surface = self.body_surface(new.surface().unwrap_or(&scene::Surface::default()));
        let is_changed = old != Some(new);
        match (named, new, old) {
            (&NamedEntity::Body { body, .. }, _, Some(was))
                if was.mesh() == new.mesh() && is_described(was, new) =>
            {
                insert_if_other(world, body, settings);
                insert_if_other(world, body, surface);
                if is_changed {
                    self.describe_anew(world, name, [was, new]);
                    for entity in self.entities.entities(name) {
                        set_touch(world, entity, new.layers(), new.reports_contacts());
                    }
                }
            }
            (NamedEntity::Rig { particles, .. }, Body::Rig(rig), Some(Body::Rig(was))) => {
                let (solver, touch) = (was.solver.clone(), was.surface.clone());
                let is_only_numbers = scene::Rig { solver, surface: touch, ..rig.clone() } == *was;
                if is_only_numbers {
                    for &particle in particles {
                        insert_if_other(world, particle, settings);
                        insert_if_other(world, particle, surface);
                    }
                } else {
                    self.entities.despawn(world, name);
                    self.spawn_body(world, name, new);
                }
            }
            _ if is_changed => {
                self.entities.despawn(world, name);
                self.spawn_body(world, name, new);
            }
            _ => {}
        }
    }

    /// Applies the differences between two descriptions of a body to its entity. A body that is rebuilt loses its
    /// pieces.
    fn describe_anew(&mut self, world: &mut World, name: &str, [was, is]: [&Body; 2]) {
        let entities = self.entities.entities(name);
        for &entity in &entities {
            set_tearable(world, entity, is);
            set_pressure(world, entity, is);
        }
        let Some(&entity) = entities.first() else { return };
        let has_changed = match (was, is) {
            (Body::Cloth(was), Body::Cloth(is)) => {
                replace(world, entity, [was, is].map(Cloth::from))
                    | replace(world, entity, [was, is].map(Fabric::from))
            }
            (Body::Rope(was), Body::Rope(is)) => replace(world, entity, [was, is].map(Rope::from)),
            (Body::ClothMesh(was), Body::ClothMesh(is)) => {
                replace(world, entity, [was, is].map(ClothMesh::from))
                    | replace(world, entity, [was, is].map(Fabric::from))
            }
            (Body::SoftBall(was), Body::SoftBall(is)) => {
                replace(world, entity, [was, is].map(SoftBall::from))
            }
            (Body::SoftBody(was), Body::SoftBody(is)) => {
                replace(world, entity, [was, is].map(SoftBodyMesh::from))
            }
            _ => false,
        };
        if has_changed {
            self.entities.despawn_pieces(world, name);
        }
        if let Some((at, turn)) = is.place().filter(|place| was.place() != Some(*place)) {
            world.entity_mut(entity).insert(place(at, turn));
        }
    }
}

/// Replaces the description of a body if it differs. Returns true if it does.
fn replace<D: Component + PartialEq>(world: &mut World, entity: Entity, [was, is]: [D; 2]) -> bool {
    let has_changed = is != was;
    if has_changed {
        world.entity_mut(entity).insert(is);
    }
    has_changed
}

/// True if the plugin builds both bodies from descriptions of the same kind.
fn is_described(was: &Body, is: &Body) -> bool {
    core::mem::discriminant(was) == core::mem::discriminant(is)
        && !matches!(is, Body::Rig(_) | Body::Balls(_))
}

fn insert_if_other<C: Component + PartialEq>(world: &mut World, entity: Entity, component: C) {
    if world.get::<C>(entity) != Some(&component) {
        world.entity_mut(entity).insert(component);
    }
}
