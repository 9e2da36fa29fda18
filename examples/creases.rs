//! Friction in bending: three sheets are pressed into pleats and let go. Only pleats that friction holds stay.
//!
//! `cargo run --release --example creases --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::body::BendingFriction;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Pleats let go: without friction in bending, of linen, of paper",
    controls: "",
    eye: Vec3::new(0.26, 0.5, 1.15),
    target: Vec3::new(0.0, -0.02, 0.06),
    picture_time: 3.0,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(FixedUpdate, press);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Rigidity in bending, in N m.
const RIGIDITY: f32 = 2e-5;

/// Friction in bending in N, with colours. Over the rigidity it is the curvature that a crease can keep, in 1/m.
const SHEETS: [(f32, Paint); 3] = [
    (0.0, Paint::rgb(0.75, 0.12, 0.22)),
    (8e-4, Paint::rgb(0.78, 0.70, 0.52)),
    (3e-3, Paint::rgb(0.90, 0.90, 0.88)),
];

/// Particles along a sheet, metres between them, and sticks in a panel between two creases.
const ALONG: usize = 49;
const SPACING: f32 = 0.0125;
const PANEL: usize = 4;

/// Angle in radians between a pressed panel and the ground.
const STEEP: f32 = 0.9;

/// A sheet that has yet to be pressed.
#[derive(Component)]
struct Flat;

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    for (place, (friction, paint)) in SHEETS.into_iter().enumerate() {
        let length = (ALONG - 1) as f32 * SPACING;
        let flat = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
        commands.spawn((
            Cloth::new(length, 0.3).with_particles(ALONG as u32, 25).with_pins(ClothPins::None),
            Fabric {
                areal_density: 0.1,
                bend_stiffness: 0.0,
                bending_rigidity: BendingRigidity::isotropic(RIGIDITY),
                bending_friction: BendingFriction::isotropic(friction),
                thickness: 0.003,
                friction: 0.2,
                // They open slowly: whipped open, pleats would be bent back.
                drag: 12.0,
                ..default()
            },
            SolverSettings::from(Quality::High),
            Transform::from_xyz(0.0, 0.003, 0.42 * (place as f32 - 1.0)).with_rotation(flat),
            Flat,
            paint,
        ));
    }
}

/// Presses a sheet into pleats once it has been built: panels stand up and fall in turn, and no stick is stretched.
fn press(mut sheets: Query<(Entity, &mut Particles), With<Flat>>, mut commands: Commands) {
    for (sheet, mut particles) in &mut sheets {
        let (sin, cos) = STEEP.sin_cos();
        let middle = 0.5 * (ALONG - 1) as f32;
        for i in 0..particles.len() {
            let column = i % ALONG;
            let in_pair = column % (2 * PANEL);
            let up = in_pair.min(2 * PANEL - in_pair) as f32 * SPACING * sin;
            let along = (column as f32 - middle) * SPACING * cos;
            let flat = particles.position(i);
            particles.set_position(i, Vec3::new(along, flat.y + up, flat.z));
        }
        commands.entity(sheet).remove::<Flat>();
    }
}
