//! The picture of a feature's example, without a window.

use core::time::Duration;
use std::path::Path;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

use crate::feature::example::{Feature, steps_in};
use crate::feature::materials::FeatureMaterialsPlugin;
use crate::view::gltf_files::wait_for_files;
use crate::view::offscreen::{self, PictureError};
use crate::view::viewpoint::Viewpoint;

/// Size in pixels at which the scene is drawn: twice that of the picture, for smooth edges.
const DRAWN: UVec2 = UVec2::new(960, 540);
/// Vertical angle of view in radians.
pub const FIELD_OF_VIEW: f32 = 0.7;

/// Runs `feature` for this long (simulated seconds) and draws it into a PNG file.
///
/// # Errors
/// [`PictureError`].
pub fn draw(feature: &Feature, seconds: f32, path: &Path) -> Result<(), PictureError> {
    let build = feature.build;
    let (mut app, offscreen) =
        offscreen::app((DrapePlugins::default(), FeatureMaterialsPlugin, build), DRAWN)?;
    let view = Viewpoint { eye: feature.eye, target: feature.target, field_of_view: FIELD_OF_VIEW };
    let world = app.world_mut();
    let mut cameras = world.query::<(&mut Transform, &mut Projection)>();
    if let Ok((mut transform, mut projection)) = cameras.get_mut(world, offscreen.camera()) {
        view.apply(&mut transform, &mut projection);
    }
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    let steps = steps_in(&app, seconds);
    app.update();
    wait_for_files(&mut app)?;
    for _ in 0..steps {
        app.update();
    }
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    offscreen.draw_half(&mut app, path)
}
