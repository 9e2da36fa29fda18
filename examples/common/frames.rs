//! Pictures of a run without a window: PNG files, drawn through whatever graphics adapter there is.
//!
//! The moments were kept while the scene was simulated ([`moments`](crate::moments)); here a second app, whose
//! clock stands still, shows them one after the other.

use std::path::Path;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

use crate::moments::Snapshot;
use crate::scene::{CannonScene, Ground, STEP};
use crate::studio::{PictureError, app};
use crate::visuals::VisualsPlugin;

/// Size of a picture in pixels.
const SIZE: UVec2 = UVec2::new(1280, 720);

/// Draws `snapshots` of `scene` into `folder`, one PNG file each, and tells `on_frame` of each.
///
/// # Errors
/// [`PictureError`]: no adapter, or a file that cannot be written.
pub fn draw(
    snapshots: &[Snapshot],
    scene: &CannonScene,
    folder: &Path,
    mut on_frame: impl FnMut(&Path),
) -> Result<(), PictureError> {
    let (mut app, studio) = app((DrapePlugins::default(), VisualsPlugin), SIZE)?;
    app.insert_resource(Time::<Fixed>::from_seconds(STEP))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    app.world_mut().spawn((Ground, Transform::default()));
    for snapshot in snapshots {
        let path = folder.join(snapshot.name).with_extension("png");
        show(app.world_mut(), snapshot, scene, studio.camera());
        studio.draw(&mut app, &path)?;
        on_frame(&path);
    }
    Ok(())
}

/// Marks what belongs to the snapshot that is shown.
#[derive(Component)]
struct Pictured;

/// Puts the scene of `snapshot` into the world, instead of the one before.
fn show(world: &mut World, snapshot: &Snapshot, scene: &CannonScene, camera: Entity) {
    let mut pictured = world.query_filtered::<Entity, With<Pictured>>();
    for entity in pictured.iter(world).collect::<Vec<_>>() {
        world.despawn(entity);
    }
    let body = (snapshot.particles.clone(), snapshot.sticks.clone());
    world.spawn((Pictured, scene.curtain(), body));
    for &(ball, transform) in &snapshot.balls {
        world.spawn((Pictured, ball, transform));
    }
    if let Some((cannon, transform)) = snapshot.cannon {
        world.spawn((Pictured, cannon, transform));
    }
    world.entity_mut(camera).insert(snapshot.camera());
}
