//! A wrecking ball on a rope swings into a curtain, and drags a crate along on another rope.
//!
//! `cargo run --release --example wrecking_ball --features window`; `--headless` runs without a window, with `--features
//! meshes` at least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A wrecking ball drags a crate along",
    controls: "",
    eye: Vec3::new(-1.9, 1.9, 4.3),
    target: Vec3::new(0.05, 1.5, 0.0),
    picture_time: 0.95,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Height of the beam in metres.
const BEAM: f32 = 2.8;

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let level = Quat::from_rotation_z(core::f32::consts::FRAC_PI_2);
    let steel = Paint::rgb(0.35, 0.35, 0.38);
    commands.spawn((Obstacle::capsule(0.05, 3.6), Transform::from_xyz(0.0, BEAM, 0.0).with_rotation(level)));
    for x in [-1.8, 1.8] {
        commands.spawn((Obstacle::capsule(0.05, BEAM), Transform::from_xyz(x, 0.5 * BEAM, 0.0)));
    }

    // A ball of 80 kg on a rope of 200 g, drawn aside: each pulls at the other.
    let hemp = Paint::rgb(0.70, 0.55, 0.30);
    let from = Vec3::new(-0.4, BEAM - 0.06, 0.0);
    let hook = commands.spawn(Transform::from_translation(from)).id();
    let to = from + 1.7 * Vec3::new(-0.9, -0.45, 0.0).normalize();
    let ball = (Obstacle::sphere(0.24), DynamicObstacle::sphere(80.0, 0.24), Transform::from_translation(to));
    let ball = commands.spawn((ball, steel)).id();
    let tied = Attachment::first(hook).and(Tie::last(ball));
    commands.spawn((Rope::new(from, to, 40), tied, RopeMesh::new(0.015), hemp));

    // A crate of 2 kg hangs below it. Its rope and the curtain touch.
    let touching = SolverSettings { self_contact: SelfContact::On, ..default() };
    let crate_at = to + Vec3::NEG_Y * 0.75;
    let size = Vec3::splat(0.22);
    let crate_ = (Obstacle::cuboid(size.x, size.y, size.z), DynamicObstacle::cuboid(2.0, size));
    let place = Transform::from_translation(crate_at);
    let crate_ = commands.spawn((crate_, place, Paint::rgb(0.55, 0.38, 0.20))).id();
    let tied = Attachment::first(ball).and(Tie::last(crate_));
    commands.spawn((Rope::new(to, crate_at, 40), touching, tied, RopeMesh::new(0.012), hemp));

    let curtain = Cloth::new(1.6, 1.9).with_particles(49, 57);
    let turned = Quat::from_rotation_y(core::f32::consts::FRAC_PI_2);
    let place = Transform::from_xyz(0.35, BEAM - 1.0, 0.0).with_rotation(turned);
    commands.spawn((curtain, touching, Paint::rgb(0.62, 0.16, 0.16), place));
}
