//! Scenes as Bevy assets, which restart when their file changes.

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;

use crate::load::{Override, SceneTexts, mesh_files};
use crate::mesh::MeshFiles;
use crate::play::{ScenePlugin, begin_scene};
use crate::scene::SceneScript;
use crate::text::SceneError;

/// Loads [`SceneScript`]s from `*.scene.ron` files, and plays the one that the resource [`PlayScene`] names.
///
/// With Bevy's feature `file_watcher`, a scene restarts when its file or one of its fragments is saved.
pub struct SceneAssetPlugin;

impl Plugin for SceneAssetPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<ScenePlugin>() {
            app.add_plugins(ScenePlugin);
        }
        app.init_asset::<SceneScript>()
            .init_asset_loader::<SceneScriptLoader>()
            .add_systems(PreUpdate, play_what_was_loaded);
    }
}

/// The scene to be played. The scene begins once it is loaded.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_drape_script::asset::PlayScene;
/// fn open(mut commands: Commands, assets: Res<AssetServer>) {
///     commands.insert_resource(PlayScene::new(assets.load("scenes/curtain.scene.ron")));
/// }
/// ```
#[derive(Resource, Clone, Debug)]
pub struct PlayScene {
    /// The scene.
    pub scene: Handle<SceneScript>,
    /// Values to be replaced in it.
    pub overrides: Vec<Override>,
    /// The error in the overrides, if there is one. The scene that is being played continues then.
    pub error: Option<SceneError>,
}

impl PlayScene {
    /// Plays `scene` without overrides.
    pub fn new(scene: Handle<SceneScript>) -> Self {
        Self { scene, overrides: Vec::new(), error: None }
    }
}

/// Begins the scene when it was loaded or reloaded.
fn play_what_was_loaded(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<SceneScript>>,
    scripts: Res<Assets<SceneScript>>,
    play: Option<ResMut<PlayScene>>,
) {
    let Some(mut play) = play else {
        events.clear();
        return;
    };
    let scene = play.scene.id();
    let is_news = |event: &AssetEvent<SceneScript>| event.is_added(scene) || event.is_modified(scene);
    let has_changed = events.read().filter(|event| is_news(event)).count() > 0 || play.is_added();
    let Some(script) = scripts.get(scene).filter(|_| has_changed) else { return };
    match script.clone().with(&play.overrides) {
        Ok(script) => {
            play.error = None;
            commands.queue(move |world: &mut World| begin_scene(world, script));
        }
        Err(error) => {
            error!("{error}");
            play.error = Some(error);
        }
    }
}

/// Loads scenes with their fragments and meshes.
#[derive(Default, TypePath)]
pub struct SceneScriptLoader;

impl AssetLoader for SceneScriptLoader {
    type Asset = SceneScript;
    type Settings = ();
    type Error = SceneError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<SceneScript, SceneError> {
        let mut texts = SceneTexts::new(context.path().path());
        let mut own = Some(reader);
        while let Some(path) = texts.next_unread() {
            let unreadable =
                |error: String| SceneError::new(format!("cannot be read: {error}")).in_file(&path);
            // The first text is that of the asset itself.
            let bytes = match own.take() {
                Some(reader) => {
                    let mut bytes = Vec::new();
                    reader.read_to_end(&mut bytes).await.map_err(|error| unreadable(error.to_string()))?;
                    bytes
                }
                None => {
                    let read = context.read_asset_bytes(path.clone()).await;
                    read.map_err(|error| unreadable(error.to_string()))?
                }
            };
            let text = String::from_utf8(bytes)
                .map_err(|error| SceneError::new(format!("expected text: {error}")).in_file(&path))?;
            texts.add(path, text)?;
        }
        let script = texts.script(&[])?;
        let mut files = MeshFiles::default();
        for (field, file) in mesh_files(&script) {
            let bytes = context.read_asset_bytes(texts.beside_scene(&file)).await;
            texts.add_mesh(&mut files, field, &file, bytes.map_err(|error| error.to_string()))?;
        }
        texts.finish(script, files, &[])
    }

    fn extensions(&self) -> &[&str] {
        &["scene.ron"]
    }
}
