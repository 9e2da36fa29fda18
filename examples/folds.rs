//! Cloth against itself: a long strip is let down and stacks up in folds.
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
    eye: Vec3::new(0.5, 0.4, 0.78),
    target: Vec3::new(0.0, 0.16, 0.02),
    picture_time: 4.2,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(FixedUpdate, lower);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// How fast the strip is let down, in metres per second, and the height that its upper edge comes to, in metres.
const SPEED: f32 = 0.4;
const LOWEST: f32 = 0.35;

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let strip = Cloth::new(0.4, 2.0).with_particles(17, 81);
    let fabric = Fabric { bend_stiffness: 0.9, thickness: 0.015, friction: 0.6, ..default() };
    let settings = SolverSettings { self_contact: SelfContact::On, ..default() };
    // Leans a little, so that it falls over.
    let place = Transform::from_xyz(0.0, 1.05, 0.0).with_rotation(Quat::from_rotation_x(0.03));
    commands.spawn((strip, fabric, settings, Paint::rgb(0.86, 0.80, 0.66), place));
}

/// Lowers the upper edge, which is pinned to the strip's entity.
fn lower(mut strips: Query<&mut Transform, With<Cloth>>, time: Res<Time>) {
    for mut strip in &mut strips {
        // The entity stands in the middle of the strip.
        let end = LOWEST - 1.0;
        strip.translation.y = (strip.translation.y - SPEED * time.delta_secs()).max(end);
    }
}
