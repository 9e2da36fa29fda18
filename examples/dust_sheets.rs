//! Dust sheets fall on the furniture of a glTF file. Its meshes are the obstacles, without a line about their shapes.
//!
//! `cargo run --release --example dust_sheets --features window`; `--headless` runs without a window, with `--features gltf`, and `--picture FILE` draws a picture with `--features render`.

use core::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};
use drape_examples::view::gltf_files::AwaitedFile;

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Dust sheets on furniture from a glTF file",
    controls: "",
    eye: Vec3::new(1.0, 1.35, 3.1),
    target: Vec3::new(-0.17, 0.5, 0.0),
    picture_time: 4.0,
    build: |app| {
        app.add_systems(Startup, setup);
        app.add_systems(Update, furnish.run_if(resource_exists::<AwaitedFile>));
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn(Obstacle::ground());
    commands.insert_resource(AwaitedFile(assets.load("models/furniture.glb")));
}

/// Puts the furniture in place when the file is there, and sheets above it.
fn furnish(file: Res<AwaitedFile>, files: Res<Assets<Gltf>>, mut commands: Commands) {
    let Some(file) = files.get(&file.0) else { return };
    let obstacles = ObstacleHierarchy::new(Obstacle::trimesh())
        .and_named("Vase", Obstacle::convex_hull().with_friction(0.8))
        .except_named("Rug");
    commands.spawn((WorldAssetRoot(file.scenes[0].clone()), obstacles));
    commands.remove_resource::<AwaitedFile>();
    let flat = Quat::from_rotation_x(-FRAC_PI_2);
    for (x, height, width, depth) in [(-1.55, 1.15, 1.9, 1.9), (0.0, 1.45, 1.9, 1.4), (1.4, 1.15, 1.1, 1.1)] {
        let sheet = Cloth::new(width, depth)
            .with_particles((32.0 * width) as u32, (32.0 * depth) as u32)
            .with_pins(ClothPins::None);
        let fabric = Fabric { thickness: 0.015, friction: 0.6, ..default() };
        let place = Transform::from_xyz(x, height, 0.0).with_rotation(flat);
        commands.spawn((sheet, fabric, Paint::rgb(0.86, 0.84, 0.78), place));
    }
}
