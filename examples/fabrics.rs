//! Fabrics in units: faille, two tropicals and a broadcloth, as a laboratory measured them, each over its disc.
//!
//! `cargo run --release --example fabrics --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::build::MeasuredFabric;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Polyester faille, wool and polyester tropical, cotton broadcloth, as measured",
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

/// From left to right, by their published drape, with their colours.
const FABRICS: [(MeasuredFabric, Paint); 4] = [
    (MeasuredFabric::PolyesterFaille, Paint::rgb(0.75, 0.12, 0.22)),
    (MeasuredFabric::WoolTropical, Paint::rgb(0.16, 0.24, 0.42)),
    (MeasuredFabric::PolyesterTropical, Paint::rgb(0.20, 0.42, 0.30)),
    (MeasuredFabric::CottonBroadcloth, Paint::rgb(0.86, 0.84, 0.78)),
];

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    for (place, (fabric, paint)) in FABRICS.into_iter().enumerate() {
        let x = 0.4 * (place as f32 - 1.5);
        commands.spawn((Obstacle::cylinder(0.09, 0.3), Transform::from_xyz(x, 0.15, 0.0)));
        let flat = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
        commands.spawn((
            Cloth::new(0.32, 0.32).with_particles(27, 27).with_pins(ClothPins::None),
            Fabric { thickness: 0.003, static_friction: 1.0, ..Fabric::measured(fabric) },
            SolverSettings::from(Quality::High),
            Transform::from_xyz(x, 0.31, 0.0).with_rotation(flat),
            paint,
        ));
    }
}
