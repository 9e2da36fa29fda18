//! Cloth laid over whatever there is: sphere, box, capsule, cylinder, cone.
//!
//! `cargo run --release --example drape --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Cloths at rest on five shapes",
    controls: "",
    eye: Vec3::new(3.3, 1.4, 2.6),
    target: Vec3::new(1.12, 0.42, 0.0),
    picture_time: 3.0,
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
    let obstacles = [
        (Obstacle::sphere(0.4), 0.4),
        (Obstacle::cuboid(0.7, 0.7, 0.7), 0.35),
        (Obstacle::cylinder(0.3, 0.9), 0.45),
        (Obstacle::cone(0.4, 0.9), 0.45),
        (Obstacle::capsule(0.2, 0.7), 0.55),
    ];
    for (place, (obstacle, height)) in obstacles.into_iter().enumerate() {
        let x = 1.35 * (place as f32 - 2.0);
        commands.spawn((obstacle, Transform::from_xyz(x, height, 0.0)));
        let cloth = Cloth::new(1.15, 1.15).with_particles(44, 44).with_pins(ClothPins::None);
        let flat = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
        let paint = Paint::rgb(0.85 - 0.14 * place as f32, 0.42, 0.22 + 0.12 * place as f32);
        let fabric = Fabric { thickness: 0.02, ..default() };
        commands.spawn((cloth, fabric, paint, Transform::from_xyz(x, 1.3, 0.0).with_rotation(flat)));
    }
}
