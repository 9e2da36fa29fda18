//! Cloth that tears: cloths of three strengths in frames, and a ball at each.
//!
//! `cargo run --release --example tear --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Three cloths of different strength",
    controls: "",
    eye: Vec3::new(2.0, 1.6, 3.6),
    target: Vec3::new(0.1, 0.98, -0.2),
    picture_time: 0.62,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Particles along a side.
const SIDE: u32 = 40;

/// The particles of the four edges.
fn frame() -> Vec<u32> {
    let is_at_edge = |place: u32| place == 0 || place == SIDE - 1;
    (0..SIDE * SIDE).filter(|i| is_at_edge(i % SIDE) || is_at_edge(i / SIDE)).collect()
}

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let weak = (0.05, Paint::rgb(0.72, 0.20, 0.16));
    let strong = (0.2, Paint::rgb(0.85, 0.62, 0.20));
    let strongest = (1.0, Paint::rgb(0.20, 0.36, 0.55));
    for (x, (strain, paint)) in [(-1.5, weak), (0.0, strong), (1.5, strongest)] {
        let cloth = Cloth::new(1.3, 1.3).with_particles(SIDE, SIDE).with_pins(ClothPins::Indices(frame()));
        let tearable = Tearable { strain, ..default() };
        commands.spawn((cloth, tearable, paint, Transform::from_xyz(x, 1.3, 0.0)));
        let ball = Projectile { radius: 0.16, mass: 4.0, velocity: Vec3::new(0.0, 1.5, -11.0), ..default() };
        commands.spawn((ball, Transform::from_xyz(x, 0.9, 4.0)));
    }
}
