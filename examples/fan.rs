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
    eye: Vec3::new(0.8, 1.3, 3.1),
    target: Vec3::new(0.05, 0.85, 0.0),
    picture_time: 2.0,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(Update, spin);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// What carries the blades.
#[derive(Component)]
struct Hub;

fn setup(mut commands: Commands, mut wind: ResMut<Wind>) {
    wind.lift_coefficient = 0.6;
    commands.spawn(Obstacle::ground());
    let region = WindRegion::Cuboid(Vec3::new(1.6, 0.45, 0.45));
    let fan = WindZone { region, flow: WindFlow::Along(Vec3::X * 3.0), falloff: 0.4 };
    commands.spawn((fan, Transform::from_xyz(0.0, 0.95, 0.0)));
    // Only to look at: hub, blades and post touch nothing.
    let seen = |shape: Obstacle, grey: f32| (shape, DrapeLayers::new(0, 0), Paint::rgb(grey, grey, grey));
    let place = Transform::from_xyz(-1.5, 0.95, 0.0);
    let hub = commands.spawn((Hub, seen(Obstacle::sphere(0.07), 0.30), place)).id();
    commands.spawn((seen(Obstacle::capsule(0.03, 0.9), 0.30), Transform::from_xyz(-1.6, 0.5, 0.0)));
    for blade in 0..5_u8 {
        let turned = Quat::from_rotation_x(0.4 * core::f32::consts::PI * f32::from(blade));
        let pitched = Transform::from_rotation(turned * Quat::from_rotation_y(0.5));
        let place = pitched * Transform::from_xyz(0.0, 0.24, 0.0);
        commands.spawn((seen(Obstacle::cuboid(0.02, 0.36, 0.16), 0.75), place, ChildOf(hub)));
    }
    // So far apart that none reaches the next.
    for strip in 0..5_u8 {
        let x = -1.0 + 0.65 * f32::from(strip);
        let ribbon = Cloth::new(0.7, 0.6).with_particles(21, 18);
        let paint = Paint::rgb(0.85, 0.30 + 0.10 * f32::from(strip), 0.25);
        let place = Transform::from_xyz(x, 1.05, 0.0).with_rotation(Quat::from_rotation_y(1.571));
        commands.spawn((ribbon, paint, place));
    }
}

/// Once a second.
fn spin(mut hub: Single<&mut Transform, With<Hub>>, time: Res<Time>) {
    hub.rotate_local_x(core::f32::consts::TAU * time.delta_secs());
}
