//! Capes from a glTF file, as an artist exports them: loaded by Bevy, dressed when they are there, moved by the file's animations.
//! `docs/blender.md` tells how such a file is made, and quotes from this one.
//!
//! `cargo run --release --example cape_gltf --features window`; `--headless` runs without a window, with `--features gltf`, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_drape::prelude::*;
use bevy_drape::render::PaintChannel;
use bevy_drape::transform::MovedByFrame;
use drape_examples::feature::Feature;
use drape_examples::view::gltf_files::AwaitedFile;

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Capes from a glTF file, moved by its animations",
    controls: "",
    eye: Vec3::new(4.65, 1.3, 2.65),
    target: Vec3::new(2.0, 0.88, -0.2),
    picture_time: 7.4,
    build: |app| {
        app.add_systems(Startup, setup);
        app.add_systems(Update, (enter.run_if(resource_exists::<AwaitedFile>), go_round, hide_capsules));
    },
};

/// The file, in the folder of assets. `examples/models.rs` writes it.
pub const FILE: &str = "models/cape.glb";

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Somebody who goes round in a circle.
#[derive(Component, Clone, Debug)]
struct Wearer {
    /// In m/s.
    speed: f32,
    /// The animation that goes with it.
    clip: Handle<AnimationClip>,
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn(Obstacle::ground());
    // The file as a whole: Bevy loads a file once more for each part that is asked for, and spawns its scenes again each time.
    commands.insert_resource(AwaitedFile(assets.load(FILE)));
}

/// Lets two wearers in when the file is there.
fn enter(file: Res<AwaitedFile>, files: Res<Assets<Gltf>>, mut commands: Commands) {
    let Some(file) = files.get(&file.0) else { return };
    for (animation, speed, x) in [("Walk", 1.5, -1.2_f32), ("Run", 5.0, 3.0)] {
        let place = Transform::from_xyz(x, 0.0, 0.0).looking_to(Vec3::NEG_Z * x, Vec3::Y);
        let wearer = Wearer { speed, clip: file.named_animations[animation].clone() };
        commands.spawn((WorldAssetRoot(file.scenes[0].clone()), wearer, place)).observe(dress).observe(play);
    }
    commands.remove_resource::<AwaitedFile>();
}

/// Makes cloth of the cape, and fits capsules to the figure, when the scene is there.
pub fn dress(
    ready: On<WorldInstanceReady>,
    children: Query<&Children>,
    names: Query<&Name>,
    mut commands: Commands,
) {
    let root = ready.entity;
    commands.entity(root).insert(MovedByFrame);
    for entity in children.iter_descendants(root) {
        let Ok(name) = names.get(entity) else { continue };
        // The entities of the meshes: children of their nodes, called by mesh and material.
        if name.as_str() == "Figure.skin" {
            commands.entity(entity).insert(BodyColliders { friction: 0.3, ..default() });
        }
        if name.as_str() == "Cape.cloth" {
            let paint =
                ClothPaint { max_distance: Some(PaintChannel::Green), full_distance: 0.7, ..default() };
            let cape = ClothMesh { paint, ..default() };
            let fabric = Fabric { areal_density: 0.3, drag: 1.0, thickness: 0.01, ..default() };
            let motion = WorldMotion::of(root).with_scale(0.8, 0.5);
            commands.entity(entity).insert((cape, fabric, motion));
        }
    }
}

/// Plays the animation of a wearer, over and over.
fn play(
    ready: On<WorldInstanceReady>,
    wearers: Query<&Wearer>,
    children: Query<&Children>,
    mut players: Query<&mut AnimationPlayer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut commands: Commands,
) {
    let Ok(wearer) = wearers.get(ready.entity) else { return };
    for entity in children.iter_descendants(ready.entity) {
        let Ok(mut player) = players.get_mut(entity) else { continue };
        let (graph, node) = AnimationGraph::from_clip(wearer.clip.clone());
        player.play(node).repeat();
        commands.entity(entity).insert(AnimationGraphHandle(graphs.add(graph)));
    }
}

fn go_round(mut wearers: Query<(&Wearer, &mut Transform)>, time: Res<Time>) {
    for (wearer, mut transform) in &mut wearers {
        let angle = wearer.speed / transform.translation.length() * time.delta_secs();
        transform.rotate_around(Vec3::ZERO, Quat::from_rotation_y(angle));
    }
}

/// The figure is seen instead.
fn hide_capsules(capsules: Query<Entity, (Added<Obstacle>, With<ChildOf>)>, mut commands: Commands) {
    for capsule in &capsules {
        commands.entity(capsule).insert(Visibility::Hidden);
    }
}
