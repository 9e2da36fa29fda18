//! Pictures of a run without a window: PNG files, drawn through whatever graphics adapter there is.
//!
//! [`frame_capture`](crate::cannon_demo::frame_capture) keeps the frames during the run; here a second app, whose clock
//! stands still, shows one after the other.

use std::path::Path;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use crate::cannon_demo::frame_capture::CapturedFrame;
use crate::cannon_demo::materials::CannonMaterialsPlugin;
use crate::cannon_demo::scene::{CannonScene, Ground, STEP};
use crate::view::offscreen::{PictureError, app};

/// Size of a picture in pixels.
const SIZE: UVec2 = UVec2::new(1280, 720);

/// Draws `frames` of `scene` into `folder`, one PNG file each, and calls `on_frame` for each.
///
/// # Errors
/// [`PictureError`]: no adapter, or a file that cannot be written.
pub fn draw(
    frames: &[CapturedFrame],
    scene: &CannonScene,
    folder: &Path,
    mut on_frame: impl FnMut(&Path),
) -> Result<(), PictureError> {
    let (mut app, offscreen) = app((DrapePlugins::default(), CannonMaterialsPlugin), SIZE)?;
    app.insert_resource(Time::<Fixed>::from_seconds(STEP))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    app.world_mut().spawn((Ground, Transform::default()));
    for frame in frames {
        let path = folder.join(frame.name).with_extension("png");
        show(app.world_mut(), frame, scene, offscreen.camera());
        offscreen.draw(&mut app, &path)?;
        on_frame(&path);
    }
    Ok(())
}

/// Marks what belongs to the frame that is shown.
#[derive(Component)]
struct InFrame;

/// Puts the scene of `frame` into the world, instead of the one before.
fn show(world: &mut World, frame: &CapturedFrame, scene: &CannonScene, camera: Entity) {
    let mut old = world.query_filtered::<Entity, With<InFrame>>();
    for entity in old.iter(world).collect::<Vec<_>>() {
        world.despawn(entity);
    }
    let body = (frame.particles.clone(), frame.sticks.clone());
    world.spawn((InFrame, scene.curtain(), body));
    for &(ball, transform) in &frame.balls {
        world.spawn((InFrame, ball, transform));
    }
    if let Some((cannon, transform)) = frame.cannon {
        world.spawn((InFrame, cannon, transform));
    }
    world.entity_mut(camera).insert(frame.camera());
}
