//! Pictures and films of a feature's example, without a window.

use core::time::Duration;
use std::path::Path;

use bevy::pbr::ScreenSpaceAmbientOcclusion;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

use crate::feature::example::{Feature, steps_in};
use crate::feature::materials::FeatureMaterialsPlugin;
use crate::view::gltf_files::wait_for_files;
use crate::view::offscreen::{self, OffscreenCamera, PictureError};
use crate::view::viewpoint::Viewpoint;

/// Size in pixels at which the scene is drawn: twice that of the picture, for smooth edges.
const DRAWN: UVec2 = UVec2::new(2560, 1440);
/// The same for films.
const FILMED: UVec2 = UVec2::new(960, 540);
/// Vertical angle of view in radians.
pub const FIELD_OF_VIEW: f32 = 0.7;
/// Pictures for each second of a film.
const RATE: u32 = 25;

/// Runs `feature` for this long (simulated seconds) and draws it into a PNG file.
///
/// # Errors
/// [`PictureError`].
pub fn draw(feature: &Feature, seconds: f32, path: &Path) -> Result<(), PictureError> {
    let (mut app, offscreen) = open(feature, DRAWN)?;
    run(&mut app, seconds);
    app.world_mut().entity_mut(offscreen.camera()).insert(fine_shadows());
    draw_now(&mut app, &offscreen, path)
}

/// Draws three seconds of `feature`, from its start or from a second and a half before `seconds` (simulated): PNG files in
/// `folder`, 25 for each second.
///
/// # Errors
/// [`PictureError`].
pub fn film(feature: &Feature, seconds: f32, folder: &Path) -> Result<(), PictureError> {
    let reason =
        |error: std::io::Error| PictureError::File { path: folder.into(), reason: error.to_string() };
    std::fs::create_dir_all(folder).map_err(reason)?;
    let (mut app, offscreen) = open(feature, FILMED)?;
    // Bodies are built in the first step.
    run(&mut app, (seconds - 1.5).max(0.1));
    for picture in 0..3 * RATE {
        draw_now(&mut app, &offscreen, &folder.join(format!("frame_{picture:05}.png")))?;
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(1) / RATE));
        app.update();
    }
    Ok(())
}

/// Begins the example in an app that draws without a window.
fn open(feature: &Feature, size: UVec2) -> Result<(App, OffscreenCamera), PictureError> {
    let build = feature.build;
    let (mut app, offscreen) =
        offscreen::app((DrapePlugins::default(), FeatureMaterialsPlugin, build), size)?;
    let view = Viewpoint { eye: feature.eye, target: feature.target, field_of_view: FIELD_OF_VIEW };
    let world = app.world_mut();
    let mut cameras = world.query::<(&mut Transform, &mut Projection)>();
    if let Ok((mut transform, mut projection)) = cameras.get_mut(world, offscreen.camera()) {
        view.apply(&mut transform, &mut projection);
    }
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.update();
    wait_for_files(&mut app)?;
    Ok((app, offscreen))
}

/// The shade in folds, and where things stand on each other: too slow for a window on any machine, and for films.
fn fine_shadows() -> impl Bundle {
    let occlusion = ScreenSpaceAmbientOcclusion {
        // Smaller ones leave stripes on walls.
        radius: 2.0,
        // As thick as cloth rather than as furniture.
        constant_object_thickness: 0.1,
        ..default()
    };
    // Ambient occlusion asks for it. The picture is drawn at twice its size.
    (occlusion, Msaa::Off)
}

fn run(app: &mut App, seconds: f32) {
    for _ in 0..steps_in(app, seconds) {
        app.update();
    }
}

/// Draws what the app shows now, while its clock stands still.
fn draw_now(app: &mut App, offscreen: &OffscreenCamera, path: &Path) -> Result<(), PictureError> {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    offscreen.draw_half(app, path)
}
