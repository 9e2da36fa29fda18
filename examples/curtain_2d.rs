//! A curtain in two dimensions: a grid of sticks in a plane, its top row pinned, relaxed five times a step, and a disc that
//! swings through it. With a `Mesh2d` and a `Camera2d` the same is drawn flat.
//!
//! `cargo run --release --example curtain_2d --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::attach::PlaneLock;
use bevy_drape::body::StructuralSolve;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A curtain in a plane, five passes a step",
    controls: "",
    eye: Vec3::new(0.5, 1.35, 2.4),
    target: Vec3::new(0.05, 1.28, 0.0),
    picture_time: 1.7,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(FixedUpdate, swing);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// A disc that swings to and fro.
#[derive(Component)]
struct Disc;

fn setup(mut commands: Commands) {
    // Nothing but the sticks to the left and up.
    let curtain = Cloth::new(1.6, 1.2).with_particles(33, 25);
    let fabric = Fabric { shear_stiffness: 0.0, bend_stiffness: 0.0, ..default() };
    let passes =
        SolverSettings { substeps: 1, iterations: 5, structural: StructuralSolve::Sweeps, ..default() };
    let place = Transform::from_xyz(0.0, 1.4, 0.0);
    commands.spawn((curtain, fabric, passes, PlaneLock::default(), Paint::rgb(0.25, 0.45, 0.70), place));
    // Its middle is in the plane: what it pushes stays there.
    commands.spawn((Disc, Obstacle::sphere(0.16), Transform::from_xyz(-1.4, 0.78, 0.0)));
}

fn swing(time: Res<Time>, mut discs: Query<&mut Transform, With<Disc>>) {
    for mut disc in &mut discs {
        disc.translation.x = -1.4 * (1.2 * time.elapsed_secs()).cos();
    }
}
