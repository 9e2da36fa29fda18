//! Soft balls in the plane: jellies of rings of particles drop onto pegs.
//!
//! `cargo run --release --example soft_ball --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use core::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_drape::attach::PlaneLock;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Soft balls of three stiffnesses",
    controls: "",
    eye: Vec3::new(0.5, 1.2, 3.1),
    target: Vec3::new(0.0, 1.0, 0.0),
    picture_time: 0.47,
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
    for (x, stiffness, paint) in [
        (-1.1, 0.9, Paint::rgb(0.80, 0.25, 0.35)),
        (0.0, 0.985, Paint::rgb(0.30, 0.62, 0.40)),
        (1.1, 0.9999, Paint::rgb(0.28, 0.42, 0.75)),
    ] {
        let ball = SoftBall { stiffness, ..SoftBall::new(0.35) };
        commands.spawn((ball, PlaneLock::default(), paint, Transform::from_xyz(x, 1.8, 0.0)));
        // Across the plane: what it pushes stays there.
        let peg = Transform::from_xyz(x + 0.08, 0.75, 0.0).with_rotation(Quat::from_rotation_x(FRAC_PI_2));
        commands.spawn((Obstacle::capsule(0.12, 0.4), peg));
    }
}
