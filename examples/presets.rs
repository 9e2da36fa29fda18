//! Materials by name, side by side: a cloth of each is drawn over a post.
//!
//! `cargo run --release --example presets --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Silk, cotton, denim, leather, rubber, net, chain",
    controls: "",
    eye: Vec3::new(3.6, 1.5, 2.9),
    target: Vec3::new(1.15, 0.45, 0.0),
    picture_time: 2.5,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// From left to right, with their colours.
const MATERIALS: [(Fabric, Paint); 7] = [
    (Fabric::SILK, Paint::rgb(0.75, 0.12, 0.22)),
    (Fabric::COTTON, Paint::rgb(0.86, 0.84, 0.78)),
    (Fabric::DENIM, Paint::rgb(0.16, 0.24, 0.42)),
    (Fabric::LEATHER, Paint::rgb(0.36, 0.20, 0.11)),
    (Fabric::RUBBER, Paint::rgb(0.12, 0.12, 0.12)),
    (Fabric::NET, Paint::rgb(0.30, 0.45, 0.20)),
    (Fabric::CHAIN, Paint::rgb(0.55, 0.57, 0.60)),
];

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    for (place, (fabric, paint)) in MATERIALS.into_iter().enumerate() {
        let x = 0.95 * (place as f32 - 3.0);
        // Its foot is in the ground.
        commands.spawn((Obstacle::capsule(0.16, 1.0), Transform::from_xyz(x, 0.35, 0.0)));
        // Flat, above the post.
        let flat = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
        commands.spawn((
            Cloth::new(0.8, 0.8).with_particles(24, 24).with_pins(ClothPins::None),
            Fabric { static_friction: 1.0, ..fabric },
            Transform::from_xyz(x, 1.1, 0.0).with_rotation(flat),
            paint,
        ));
    }
}
