//! Cloth against itself: a long strip is laid down and stacks up in folds.
//!
//! `cargo run --release --example folds --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A strip lays itself down in folds",
    controls: "",
    eye: Vec3::new(0.75, 0.6, 1.2),
    target: Vec3::new(0.0, 0.12, 0.05),
    picture_time: 2.4,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let strip = Cloth::new(0.4, 2.0).with_particles(17, 81).with_pins(ClothPins::None);
    let fabric = Fabric { thickness: 0.025, friction: 0.6, ..default() };
    let settings = SolverSettings { self_contact: SelfContact::On, ..default() };
    // Leans a little, so that it falls over.
    let place = Transform::from_xyz(0.0, 1.05, 0.0).with_rotation(Quat::from_rotation_x(0.03));
    commands.spawn((strip, fabric, settings, Paint::rgb(0.86, 0.80, 0.66), place));
}
