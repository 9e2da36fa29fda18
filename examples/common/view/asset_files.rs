//! Asset files: meshes and images from the folder `assets`.

use bevy::asset::{AssetMetaCheck, AssetPlugin};
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::scene::ScenePlugin;

/// Assets in the repository's folder, wherever the program lies or is called from. In a browser, in the folder beside the page.
pub fn asset_plugin() -> AssetPlugin {
    if cfg!(target_family = "wasm") {
        // A server says that files are not there by an error.
        AssetPlugin { meta_check: AssetMetaCheck::Never, ..default() }
    } else {
        AssetPlugin { file_path: concat!(env!("CARGO_MANIFEST_DIR"), "/assets").into(), ..default() }
    }
}

/// Meshes, animations and scenes, for an app without a renderer; with the feature `gltf`, glTF files too.
pub struct MeshFilePlugins;

impl Plugin for MeshFilePlugins {
    fn build(&self, app: &mut App) {
        app.add_plugins((asset_plugin(), MeshPlugin, ImagePlugin::default()));
        #[cfg(feature = "gltf")]
        app.add_plugins(crate::view::gltf_files::GltfFilePlugins);
        app.add_plugins((AnimationPlugin, ScenePlugin));
    }
}
