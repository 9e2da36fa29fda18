//! Layers: what passes through what. The red ball meets the red curtain only, the blue one the blue.
//!
//! `cargo run --release --example layers --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Balls that meet cloth of their own layer only",
    controls: "",
    eye: Vec3::new(2.4, 1.5, 2.0),
    target: Vec3::new(0.0, 1.0, -0.3),
    picture_time: 0.42,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// A layer that touches nothing but itself.
const fn alone(layer: u32) -> DrapeLayers {
    DrapeLayers::new(1 << layer, 1 << layer)
}

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let red = (alone(1), Paint::rgb(0.75, 0.22, 0.20));
    let blue = (alone(2), Paint::rgb(0.22, 0.35, 0.70));
    for (side, (layer, paint)) in [(-1.0, red), (1.0, blue)] {
        let curtain = Cloth::new(1.8, 1.5).with_particles(40, 34);
        commands.spawn((curtain, layer, paint, Transform::from_xyz(0.0, 1.1, -0.6 * side)));
        let ball = Projectile { radius: 0.15, mass: 2.0, velocity: Vec3::new(0.0, 1.5, -10.0), ..default() };
        commands.spawn((ball, layer, paint, Transform::from_xyz(0.45 * side, 1.0, 4.0)));
    }
}
