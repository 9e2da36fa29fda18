//! Air in closed cloth: the same ball with little, enough and much air in it.
//!
//! `cargo run --release --example balloon --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::body::Pressure;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Balls with little and with much air",
    controls: "",
    eye: Vec3::new(0.9, 1.05, 2.7),
    target: Vec3::new(0.08, 0.42, 0.0),
    picture_time: 2.2,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    commands.spawn(Obstacle::ground());
    let ball = meshes.add(Sphere::new(0.4).mesh().uv(32, 20));
    for (x, pressure, paint) in [
        (-1.1, 0.35, Paint::rgb(0.75, 0.30, 0.25)),
        (0.0, 1.0, Paint::rgb(0.90, 0.70, 0.30)),
        (1.1, 1.5, Paint::rgb(0.35, 0.55, 0.45)),
    ] {
        let skin = (ClothMesh::default(), Fabric { bend_stiffness: 0.05, ..default() });
        let turned = Transform::from_xyz(x, 1.2, 0.0).with_rotation(Quat::from_rotation_x(0.4));
        commands.spawn((Mesh3d(ball.clone()), skin, Pressure(pressure), paint, turned));
    }
}
