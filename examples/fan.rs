//! A wind zone: a fan blows at strips of cloth in still air.
//!
//! `cargo run --release --example fan --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::environment::{WindFlow, WindRegion};
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A fan: wind in one place only",
    controls: "",
    eye: Vec3::new(1.2, 1.5, 2.9),
    target: Vec3::new(0.12, 0.9, 0.0),
    picture_time: 2.0,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands, mut wind: ResMut<Wind>) {
    wind.lift_coefficient = 0.6;
    commands.spawn(Obstacle::ground());
    let region = WindRegion::Cuboid(Vec3::new(1.6, 0.45, 0.45));
    let fan = WindZone { region, flow: WindFlow::Along(Vec3::X * 6.0), falloff: 0.4 };
    commands.spawn((fan, Transform::from_xyz(0.0, 0.95, 0.0)));
    commands.spawn((
        Obstacle::cuboid(0.12, 0.7, 0.7),
        Paint::rgb(0.75, 0.75, 0.72),
        Transform::from_xyz(-1.5, 0.95, 0.0),
    ));
    // So far apart that none reaches the next.
    for strip in 0..5_u8 {
        let x = -1.0 + 0.65 * f32::from(strip);
        let ribbon = Cloth::new(0.7, 0.6).with_particles(21, 18);
        let paint = Paint::rgb(0.85, 0.30 + 0.10 * f32::from(strip), 0.25);
        let place = Transform::from_xyz(x, 1.2, 0.0).with_rotation(Quat::from_rotation_y(1.571));
        commands.spawn((ribbon, paint, place));
    }
}
