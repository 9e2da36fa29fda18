//! A rig: one entity for each particle, joined by entities that are sticks. A bridge that sags.
//!
//! `cargo run --release --example bridge --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::rig::{Particle, Stick};
use drape_examples::feature::Feature;

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A bridge of particles and sticks that are entities",
    controls: "",
    eye: Vec3::new(1.5, 1.75, 2.7),
    target: Vec3::new(0.0, 0.75, 0.0),
    picture_time: 2.5,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Planks of the bridge.
const PLANKS: usize = 14;
/// Half its width in metres.
const HALF_WIDTH: f32 = 0.35;

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    for side in [-1.0, 1.0] {
        commands.spawn((Obstacle::cuboid(0.5, 1.1, 1.0), Transform::from_xyz(side * 1.85, 0.55, 0.0)));
    }
    let step = 3.2 / PLANKS as f32;
    let mut last: Option<[Entity; 2]> = None;
    for plank in 0..=PLANKS {
        let is_end = plank == 0 || plank == PLANKS;
        let x = step * plank as f32 - 1.6;
        let mut particle = |z: f32| {
            let particle = if is_end { Particle::pinned() } else { Particle::new(0.4) };
            commands.spawn((particle, Transform::from_xyz(x, 1.1, z))).id()
        };
        let ends = [particle(-HALF_WIDTH), particle(HALF_WIDTH)];
        commands.spawn(Stick::new(ends[0], ends[1]));
        if let Some(last) = last {
            for (from, to) in [(0, 0), (1, 1), (0, 1), (1, 0)] {
                let straight = step.hypot(if from == to { 0.0 } else { 2.0 * HALF_WIDTH });
                // A little too long, so that the bridge sags.
                let rest_length = Some(straight + 0.03 * step);
                commands.spawn(Stick { rest_length, ..Stick::new(last[from], ends[to]) });
            }
        }
        last = Some(ends);
    }
}
