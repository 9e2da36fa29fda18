//! Rigid bodies of four particles and six sticks: crates and stones that tumble down a ramp.
//!
//! `cargo run --release --example crates --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::body::DefaultSolverSettings;
use bevy_drape::build::RigidTetrahedron;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Crates and stones, each of four particles",
    controls: "",
    eye: Vec3::new(2.0, 1.9, 3.2),
    target: Vec3::new(-0.4, 0.45, 0.0),
    picture_time: 1.4,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands, mut defaults: ResMut<DefaultSolverSettings>) {
    defaults.iterations = 4;
    commands.spawn(Obstacle::ground());
    let ramp = Transform::from_xyz(-0.6, 0.55, 0.0).with_rotation(Quat::from_rotation_z(-0.5));
    commands.spawn((Obstacle::cuboid(2.6, 0.1, 3.0), ramp));
    for i in 0..6 {
        let place =
            Vec3::new(-1.4 + 0.15 * (i % 3) as f32, 1.7 + 0.5 * (i % 2) as f32, -1.2 + 0.45 * i as f32);
        let tilt = Quat::from_euler(EulerRot::XYZ, 0.4 * i as f32, 0.9, 0.3 * i as f32);
        let at = Transform::from_translation(place).with_rotation(tilt);
        let mut body = RigidTetrahedron::cuboid(6.0, Vec3::new(0.2, 0.14, 0.16));
        if i % 2 == 1 {
            // The corners cut off: a stone of twelve corners.
            let edges = [
                [1.0, 1.0, 0.0],
                [1.0, -1.0, 0.0],
                [0.0, 1.0, 1.0],
                [0.0, 1.0, -1.0],
                [1.0, 0.0, 1.0],
                [1.0, 0.0, -1.0],
            ];
            let corners = edges.map(|edge| Vec3::from(edge) * Vec3::new(0.2, 0.16, 0.18));
            body.corners = corners.into_iter().flat_map(|corner| [corner, -corner]).collect();
            commands.spawn((body, at, Paint::rgb(0.42, 0.40, 0.38)));
        } else {
            commands.spawn((body, at, Paint::rgb(0.55, 0.38, 0.20)));
        }
    }
}
