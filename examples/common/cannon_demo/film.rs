//! A film of the bombardment: a part of each shot, from a place of its own, drawn through whatever graphics adapter there is.

use core::time::Duration;
use std::path::Path;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

use crate::cannon_demo::materials::CannonMaterialsPlugin;
use crate::cannon_demo::plugin::CannonScenePlugin;
use crate::cannon_demo::scene::{CannonScene, STEP};
use crate::cannon_demo::shot::{SHOT_INTERVAL, Shot};
use crate::cannon_demo::views::{BEHIND, CANNON, LEFT, RIGHT, View};
use crate::view::offscreen::{PictureError, app};

/// Size in pixels at which the scene is drawn: twice that of the film, for smooth edges.
const DRAWN: UVec2 = UVec2::new(1920, 1080);
/// Steps between two pictures: 30 pictures a second.
const STEPS: u32 = 2;
/// Seconds from the first picture of a shot to the shot, and to the last one.
const BEFORE: f64 = 0.1;
const AFTER: f64 = 2.2;
const _: () = assert!(BEFORE + AFTER < SHOT_INTERVAL, "one shot after another");
/// Seconds after the first shot in which it is seen from behind the cannon.
const BEHIND_CANNON: f64 = 0.45;

/// The place of the camera for one shot after another.
const VIEWS: [View; 5] = [
    View { eye: Vec3::new(1.6, 1.9, 6.4), target: Vec3::new(0.0, 1.55, 0.0) },
    RIGHT,
    BEHIND,
    LEFT,
    View { eye: Vec3::new(4.9, 1.4, -5.2), target: Vec3::new(0.0, 1.4, -0.4) },
];

/// Draws the shots of `scene` into `folder`, one PNG file for each picture, and calls `on_picture` for each.
///
/// # Errors
/// `PictureError`: no adapter, or a file that cannot be written.
pub fn draw(
    scene: &CannonScene,
    folder: &Path,
    mut on_picture: impl FnMut(&Path),
) -> Result<(), PictureError> {
    let plugins = (DrapePlugins::default(), CannonMaterialsPlugin, CannonScenePlugin(scene.clone()));
    let (mut app, offscreen) = app(plugins, DRAWN)?;
    let (mut picture, mut step) = (0, 0_u32);
    let step_at = |time: f64| (time / STEP).round() as u32;
    for index in 0..scene.shots {
        let shot = Shot::planned(index).time;
        let start = step_at(shot - BEFORE);
        let cut = if index == 0 { step_at(shot + BEHIND_CANNON) } else { 0 };
        advance(&mut app, start.saturating_sub(step));
        step = start;
        while step < step_at(shot + AFTER) {
            let view = if step < cut { CANNON } else { VIEWS[index as usize % VIEWS.len()] };
            app.world_mut().entity_mut(offscreen.camera()).insert(view.camera());
            let path = folder.join(format!("frame_{picture:05}.png"));
            offscreen.draw_half(&mut app, &path)?;
            on_picture(&path);
            advance(&mut app, STEPS);
            step += STEPS;
            picture += 1;
        }
    }
    Ok(())
}

/// Takes so many steps, and stops the clock.
fn advance(app: &mut App, steps: u32) {
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    for _ in 0..steps {
        app.update();
    }
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
}
