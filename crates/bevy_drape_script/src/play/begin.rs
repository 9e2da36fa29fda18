//! The beginning and the end of a scene.

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;

use super::change::apply_settings;
use super::scene_play::ScenePlay;
use crate::scene::SceneScript;

/// Begins `script`, in place of the scene that is being played, if there is one.
pub fn begin_scene(world: &mut World, script: SceneScript) {
    end_scene(world);
    apply_settings(world, &script.settings);
    let present = script.clone();
    let mut play = ScenePlay::new(world, script);
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
        play.entities.clear(world);
        if play.paused_for > 0 {
            world.resource_mut::<DrapeClock>().paused = false;
        }
    }
}
