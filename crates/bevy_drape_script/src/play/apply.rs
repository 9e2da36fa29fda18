//! A scene that changes while it is played: what is different is brought into the world.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::ScenePlay;
use super::stage::{Actor, mark};
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
                    let place = Transform {
                        translation: obstacle.at.get(),
                        rotation: obstacle.turn.quaternion(),
                        scale: Vec3::ONE,
                    };
                    world.entity_mut(entity).insert(place);
                }
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
        let solver = match new {
            Body::Cloth(cloth) => &cloth.solver,
            Body::Rope(rope) => &rope.solver,
            Body::Rig(rig) => &rig.solver,
            Body::Balls(_) => &scene::Solver::default(),
        };
        let settings = self.solver_settings(solver);
        let is_changed = old != Some(new);
        match (actor, new, old) {
            (&Actor::Body(entity), Body::Cloth(cloth), Some(Body::Cloth(was))) => {
                insert_if_other(world, entity, settings);
                let plain = Cloth::from(cloth);
                if plain != Cloth::from(was) {
                    world.entity_mut(entity).insert(plain);
                }
                if (cloth.at, cloth.turn) != (was.at, was.turn) {
                    let place = Transform {
                        translation: cloth.at.get(),
                        rotation: cloth.turn.quaternion(),
                        scale: Vec3::ONE,
                    };
                    world.entity_mut(entity).insert(place);
                }
                if is_changed {
                    mark(world, entity, name, cloth.layers.as_ref(), cloth.contacts);
                }
            }
            (&Actor::Body(entity), Body::Rope(rope), Some(Body::Rope(was))) => {
                insert_if_other(world, entity, settings);
                let plain = Rope::from(rope);
                if plain != Rope::from(was) {
                    world.entity_mut(entity).insert(plain);
                }
                if is_changed {
                    mark(world, entity, name, rope.layers.as_ref(), rope.contacts);
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
}

fn insert_if_other(world: &mut World, entity: Entity, settings: SolverSettings) {
    if world.get::<SolverSettings>(entity) != Some(&settings) {
        world.entity_mut(entity).insert(settings);
    }
}
