//! Bending in units: four cloths of the same weight, from silk to leather, each over the disc of a textile laboratory.
//!
//! `cargo run --release --example fabrics --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "The same weight, bending ten times as hard from cloth to cloth",
    controls: "",
    eye: Vec3::new(0.37, 0.58, 1.33),
    target: Vec3::new(0.05, 0.18, 0.0),
    picture_time: 3.0,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Rigidity in N m, from left to right: silk, shirting, canvas, leather. With their colours.
const FABRICS: [(f32, Paint); 4] = [
    (1e-6, Paint::rgb(0.75, 0.12, 0.22)),
    (1e-5, Paint::rgb(0.86, 0.84, 0.78)),
    (1e-4, Paint::rgb(0.16, 0.24, 0.42)),
    (1e-3, Paint::rgb(0.36, 0.20, 0.11)),
];

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    for (place, (rigidity, paint)) in FABRICS.into_iter().enumerate() {
        let x = 0.4 * (place as f32 - 1.5);
        commands.spawn((Obstacle::cylinder(0.09, 0.3), Transform::from_xyz(x, 0.15, 0.0)));
        let flat = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
        commands.spawn((
            Cloth::new(0.32, 0.32).with_particles(27, 27).with_pins(ClothPins::None),
            Fabric {
                areal_density: 0.2,
                bend_stiffness: 0.0,
                bending_rigidity: BendingRigidity::isotropic(rigidity),
                thickness: 0.003,
                static_friction: 1.0,
                ..default()
            },
            SolverSettings::from(Quality::High),
            Transform::from_xyz(x, 0.31, 0.0).with_rotation(flat),
            paint,
        ));
    }
}
