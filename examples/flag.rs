//! Flags in a gusty wind, one in the lee of a tower.
//!
//! `cargo run --release --example flag --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::environment::Gusts;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Gusts, and the lee of a tower",
    controls: "",
    eye: Vec3::new(0.9, 1.6, 4.2),
    target: Vec3::new(0.7, 1.45, 0.0),
    picture_time: 3.5,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands, mut wind: ResMut<Wind>) {
    *wind = Wind {
        lift_coefficient: 1.0,
        gusts: Gusts { speed: 2.0, ..default() },
        shelter: 0.9,
        ..Wind::new(Vec3::new(7.0, 0.0, 1.0))
    };
    commands.spawn(Obstacle::ground());
    let poles = [(-1.6, -0.6), (0.3, 0.5), (2.0, -1.2)];
    let paints = [Paint::rgb(0.75, 0.15, 0.15), Paint::rgb(0.93, 0.78, 0.25), Paint::rgb(0.15, 0.30, 0.60)];
    for ((x, z), paint) in poles.into_iter().zip(paints) {
        let flag = Cloth::new(1.2, 0.8).with_particles(37, 25).with_pins(ClothPins::Left);
        commands.spawn((flag, paint, Transform::from_xyz(x + 0.64, 2.1, z)));
        commands.spawn((Obstacle::capsule(0.03, 2.5), Transform::from_xyz(x, 1.25, z)));
    }
    // Behind the first flag, before the third.
    commands.spawn((Obstacle::cuboid(0.5, 3.0, 1.2), Transform::from_xyz(1.2, 1.5, -1.3)));
}
