//! The demo's results in the page of a browser: the number of shots, and the state hash after the planned ones.

use bevy::prelude::*;
use bevy_drape::cannon::CannonFired;
use clap::Parser;

use crate::cannon_demo::arguments::Arguments;
use crate::cannon_demo::headless::is_over;
use crate::cannon_demo::recorder::{Recorder, RecorderPlugin};
use crate::cannon_demo::scene::CannonScene;
use crate::view::page::{self, PagePlugin, show};

/// The arguments in the address of the page. The player fires, unless it asks for shots. Shows what is wrong with it.
pub fn arguments() -> Option<Arguments> {
    let line = page::arguments();
    match Arguments::try_parse_from(["cannon"].into_iter().chain(line.iter().map(String::as_str))) {
        Ok(arguments) if line.iter().any(|word| word == "--shots") => Some(arguments),
        Ok(arguments) => Some(Arguments { shots: 0, ..arguments }),
        Err(error) => {
            show("message", &error.to_string());
            None
        }
    }
}

/// Shows the number of shots and, if shots are planned, the state hash when all is at rest again.
pub struct CannonPagePlugin;

impl Plugin for CannonPagePlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(PagePlugin).add_systems(Update, tell_shots);
        if app.world().get_resource::<CannonScene>().is_some_and(|scene| scene.shots > 0) {
            app.add_plugins(RecorderPlugin).add_systems(Update, tell_state);
        }
    }
}

fn tell_shots(mut fired: MessageReader<CannonFired>, mut shots: Local<usize>) {
    let count = fired.read().count();
    if count > 0 {
        *shots += count;
        show("shots", &shots.to_string());
    }
}

fn tell_state(world: &mut World, mut is_told: Local<bool>) {
    if *is_told || !is_over(world, world.resource::<CannonScene>()) {
        return;
    }
    *is_told = true;
    world.resource_scope(|world, recorder: Mut<Recorder>| {
        if let Some(report) = recorder.report(world, 1) {
            show("state-hash", &report.state_hash);
        }
    });
}
