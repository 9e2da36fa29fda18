//! Scenes as assets: loaded with what they include, and begun anew when their file changes.

use std::path::{Path, PathBuf};

use bevy::asset::{AssetPlugin, LoadState};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;
use bevy_drape_script::asset::{PlayScene, SceneAssetPlugin};
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::scene::SceneScript;

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn write(folder: &Path, file: &str, text: &str) {
    std::fs::write(folder.join(file), text).expect("written");
}

fn app(folder: &Path) -> App {
    let mut app = App::new();
    let assets = AssetPlugin { file_path: folder.to_string_lossy().into_owned(), ..default() };
    app.add_plugins((MinimalPlugins, assets, DrapePlugins::default(), SceneAssetPlugin))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    app
}

/// Why a scene cannot be loaded.
fn failure(world: &World, scene: &Handle<SceneScript>) -> Option<String> {
    match world.resource::<AssetServer>().load_state(scene) {
        LoadState::Failed(error) => Some(error.to_string()),
        _ => None,
    }
}

/// Updates until `is_done`, however long a busy machine takes to read files.
fn wait(app: &mut App, scene: &Handle<SceneScript>, is_done: impl Fn(&World) -> bool) {
    while !is_done(app.world()) {
        assert_eq!(failure(app.world(), scene), None);
        std::thread::sleep(std::time::Duration::from_millis(1));
        app.update();
    }
}

fn names(world: &World) -> Vec<String> {
    let play = world.get_resource::<ScenePlay>();
    play.map(|play| play.script().bodies.keys().cloned().collect()).unwrap_or_default()
}

fn balls(app: &mut App) -> usize {
    app.world_mut().query::<&Projectile>().iter(app.world()).count()
}

#[test]
fn a_scene_is_loaded_played_and_begun_anew_when_it_changes() {
    let folder = folder("reloaded");
    write(&folder, "a.scene.ron", r#"(version: 1, include: ["part.ron"], bodies: { "one": Balls() })"#);
    write(&folder, "part.ron", r#"(version: 1, bodies: { "two": Balls(at: (3, 0, 0)) })"#);
    let mut app = app(&folder);
    let scene: Handle<SceneScript> = app.world().resource::<AssetServer>().load("a.scene.ron");
    app.insert_resource(PlayScene {
        overrides: vec!["one.copies.count=[2,1,1]".parse().expect("an override")],
        ..PlayScene::new(scene.clone())
    });
    wait(&mut app, &scene, |world| names(world) == ["one", "two"]);
    assert_eq!(balls(&mut app), 3);

    write(
        &folder,
        "a.scene.ron",
        r#"(version: 1, bodies: { "one": Balls(), "three": Balls(at: (6, 0, 0)) })"#,
    );
    app.world().resource::<AssetServer>().reload("a.scene.ron");
    wait(&mut app, &scene, |world| names(world) == ["one", "three"]);
    assert_eq!(balls(&mut app), 3, "what was there before is gone");

    // A file that cannot be read leaves the scene that is being played alone.
    write(&folder, "a.scene.ron", "(version: 1, bodies: {");
    app.world().resource::<AssetServer>().reload("a.scene.ron");
    wait(&mut app, &scene, |world| failure(world, &scene).is_some());
    (0..3).for_each(|_| app.update());
    assert_eq!(names(app.world()), ["one", "three"]);
}

#[test]
fn a_bad_scene_fails_to_load_and_says_where() {
    let folder = folder("bad_asset");
    write(&folder, "a.scene.ron", "(\n    version: 1,\n    colour: 3,\n)");
    let mut app = app(&folder);
    let scene: Handle<SceneScript> = app.world().resource::<AssetServer>().load("a.scene.ron");
    wait(&mut app, &scene, |world| failure(world, &scene).is_some());
    let error = failure(app.world(), &scene).expect("it fails");
    assert!(error.contains("a.scene.ron:3:") && error.contains("colour"), "{error}");
}
