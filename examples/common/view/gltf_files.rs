//! glTF files from the folder `assets`.

use core::time::Duration;

use bevy::asset::{LoadState, UntypedHandle};
use bevy::gltf::{Gltf, GltfPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::world_serialization::WorldSerializationPlugin;
use thiserror::Error;

/// Updates after which the scene of a loaded file must be spawned. Loading itself may take as long as the machine needs.
const PATIENCE: u32 = 1000;
/// Pause between two updates.
const PAUSE: Duration = Duration::from_millis(1);

/// A file is missing or cannot be loaded.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("cannot load a scene: {0}")]
pub struct FileError(String);

/// glTF files and the scenes in them, for an app without a renderer that has assets and meshes.
pub struct GltfFilePlugins;

impl Plugin for GltfFilePlugins {
    fn build(&self, app: &mut App) {
        app.add_plugins((WorldSerializationPlugin, GltfPlugin::default()));
    }
}

/// A file of which a system spawns something, once it is loaded. The system then removes this.
#[derive(Resource, Clone, Debug)]
pub struct AwaitedFile(pub Handle<Gltf>);

/// Updates `app` until every requested scene file is loaded and spawned. Its clock stands still meanwhile, so that results do not depend
/// on loading times.
///
/// # Errors
/// [`FileError`] with the file and its fault.
pub fn wait_for_files(app: &mut App) -> Result<(), FileError> {
    let clock = app.world_mut().remove_resource::<TimeUpdateStrategy>().unwrap_or_default();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    let mut looks = 0;
    let mut result = Ok(());
    while let Some(file) = awaited(app.world_mut()) {
        let files = app.world().resource::<AssetServer>();
        result = match files.get_load_state(file.id()) {
            Some(LoadState::Failed(error)) => Err(FileError(error.to_string())),
            Some(LoadState::Loaded) if looks == PATIENCE => {
                Err(FileError(format!("{:?} has nothing in it", file.path())))
            }
            Some(LoadState::Loaded) => {
                looks += 1;
                Ok(())
            }
            _ => Ok(()),
        };
        if result.is_err() {
            break;
        }
        std::thread::sleep(PAUSE);
        app.update();
    }
    app.insert_resource(clock);
    result
}

/// A file that is not loaded yet, or a scene that is not spawned yet.
fn awaited(world: &mut World) -> Option<UntypedHandle> {
    if let Some(file) = world.get_resource::<AwaitedFile>() {
        return Some(file.0.clone().untyped());
    }
    let mut roots = world.query_filtered::<&WorldAssetRoot, Without<Children>>();
    roots.iter(world).next().map(|root| root.0.clone().untyped())
}
