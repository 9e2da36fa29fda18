//! Soft balls in the plane: jellies of rings of particles drop onto bars and a slope.
//!
//! `cargo run --release --example soft_ball --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::attach::PlaneLock;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Soft balls of three stiffnesses",
    controls: "",
    eye: Vec3::new(0.4, 1.1, 3.3),
    target: Vec3::new(0.1, 0.85, 0.0),
    picture_time: 0.42,
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
        (-1.1, 0.99, Paint::rgb(0.80, 0.25, 0.35)),
        (0.0, 0.997, Paint::rgb(0.30, 0.62, 0.40)),
        (1.1, 0.9999, Paint::rgb(0.28, 0.42, 0.75)),
    ] {
        let ball = SoftBall { stiffness, ..SoftBall::new(0.35) };
        commands.spawn((ball, PlaneLock::default(), paint, Transform::from_xyz(x, 1.8, 0.0)));
        commands.spawn((Obstacle::capsule(0.06, 1.0), along_z(x + 0.12, 0.75)));
    }
}

/// A bar that lies along Z, so that it is a disc to what lives in the plane.
fn along_z(x: f32, y: f32) -> Transform {
    Transform::from_xyz(x, y, 0.0).with_rotation(Quat::from_rotation_x(core::f32::consts::FRAC_PI_2))
}
