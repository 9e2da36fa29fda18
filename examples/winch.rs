//! A winch lifts a load out of a well and lets it down again; the rope is drawn as a tube.
//!
//! `cargo run --release --example winch --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::attach::Winch;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A winch with ten kilograms on its rope",
    controls: "",
    eye: Vec3::new(1.5, 2.1, 3.4),
    target: Vec3::new(-0.1, 1.2, 0.0),
    picture_time: 1.2,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(FixedUpdate, turn);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let rope = Rope { end_mass: 10.0, ..Rope::new(Vec3::ZERO, Vec3::NEG_Y * 1.8, 64) };
    let winch = Winch { speed: -0.6, least: 0.4, greatest: 1.8 };
    let place = Transform::from_xyz(0.0, 2.43, 0.0);
    let paint = Paint::rgb(0.70, 0.55, 0.30);
    let rope = commands.spawn((rope, winch, RopeMesh::new(0.015), paint, place)).id();
    // Only to look at: it touches nothing.
    let load = (Obstacle::cuboid(0.3, 0.3, 0.3), DrapeLayers::new(0, 0), Paint::rgb(0.52, 0.34, 0.18));
    commands.spawn((load, FollowParticle::last(rope).with_offset(Vec3::NEG_Y * 0.15)));
    for side in 0..8_u8 {
        let turned = Quat::from_rotation_y(core::f32::consts::FRAC_PI_4 * f32::from(side));
        let place = Transform::from_rotation(turned) * Transform::from_xyz(0.0, 0.35, 0.45);
        commands.spawn((Obstacle::cuboid(0.45, 0.7, 0.12), Paint::rgb(0.60, 0.56, 0.50), place));
    }
    let beam = Transform::from_xyz(-0.33, 2.48, 0.0)
        .with_rotation(Quat::from_rotation_z(core::f32::consts::FRAC_PI_2));
    commands.spawn((Obstacle::capsule(0.05, 2.4), Transform::from_xyz(-0.75, 1.28, 0.0)));
    commands.spawn((Obstacle::capsule(0.05, 0.85), beam));
}

/// Up for three seconds, down for three.
fn turn(time: Res<Time>, mut winches: Query<&mut Winch>) {
    let is_up = time.elapsed_secs() % 6.0 < 3.0;
    for mut winch in &mut winches {
        let speed = if is_up { -0.6 } else { 0.6 };
        winch.set_if_neq(Winch { speed, ..*winch });
    }
}
