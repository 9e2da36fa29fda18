//! Ragdolls: limbs of sticks, joined by the particles that they share. Three fall down a flight of stairs.
//!
//! `cargo run --release --example ragdoll --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::rig::Ragdoll;
use drape_examples::feature::Feature;

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Ragdolls on a flight of stairs",
    controls: "",
    eye: Vec3::new(2.5, 1.7, 2.9),
    target: Vec3::new(0.3, 0.75, 0.0),
    picture_time: 0.6,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Steps of the stairs, and their height and depth in metres.
const STEPS: u32 = 6;
const HEIGHT: f32 = 0.18;
const DEPTH: f32 = 0.28;

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    for step in 0..STEPS {
        let height = HEIGHT * (STEPS - step) as f32;
        let depth = if step == 0 { 2.0 } else { DEPTH };
        let middle = Vec3::new(DEPTH * step as f32 - 0.5 * depth, 0.5 * height, 0.0);
        commands.spawn((Obstacle::cuboid(depth, height, 3.0), Transform::from_translation(middle)));
    }
    let frame = 1.0 / 60.0;
    for (place, turn, fall) in [(-0.9, 1.57, 2.0), (0.0, -1.4, 2.4), (0.9, 0.3, 1.6)] {
        let on_top = Vec3::new(-0.15, HEIGHT * STEPS as f32, place);
        let now = Transform::from_translation(on_top).with_rotation(Quat::from_rotation_y(turn));
        // They go on with the motion of an animation, of which these are the last two frames: falling over.
        let before = now.with_rotation(Quat::from_rotation_z(fall * frame) * now.rotation);
        if let Err(error) = Ragdoll::default().spawn_moving(&mut commands, before, now, frame) {
            error!("the ragdoll: {error}");
        }
    }
}
