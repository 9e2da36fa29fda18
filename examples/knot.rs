//! Knots hold by self-contact: two ropes that are laid alike, with it and without.
//!
//! `cargo run --release --example knot --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A rope that touches itself, and one that does not",
    controls: "",
    eye: Vec3::new(0.7, 1.7, 3.5),
    target: Vec3::new(0.0, 1.45, 0.0),
    picture_time: 4.0,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(FixedUpdate, lay);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Radius of the ropes, in metres.
const RADIUS: f32 = 0.022;
/// Length of the ropes, in metres.
const LENGTH: f32 = 2.4;

/// A rope that has yet to be laid in a knot.
#[derive(Component)]
struct Straight;

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let across = Quat::from_rotation_z(core::f32::consts::FRAC_PI_2);
    let bar = (Obstacle::capsule(0.04, 1.4), DrapeLayers::new(0, 0));
    commands.spawn((bar, Transform::from_xyz(0.0, 2.6, 0.0).with_rotation(across)));
    let knotted = (-0.3, SelfContact::On, Paint::rgb(0.72, 0.22, 0.18));
    let loose = (0.3, SelfContact::Off, Paint::rgb(0.24, 0.40, 0.58));
    for (x, self_contact, paint) in [knotted, loose] {
        let rope = Rope { end_mass: 0.5, ..Rope::new(Vec3::ZERO, Vec3::NEG_Y * LENGTH, 121) };
        let settings = SolverSettings { self_contact, substeps: 16, iterations: 4, ..default() };
        let surface = BodySurface { thickness: RADIUS, friction: 0.3, ..default() };
        let place = Transform::from_xyz(x, 2.6, 0.0);
        let rope =
            commands.spawn((rope, settings, surface, Straight, RopeMesh::new(RADIUS), paint, place)).id();
        // Only to look at: it touches nothing.
        let load = (Obstacle::sphere(0.05), DrapeLayers::new(0, 0), Paint::rgb(0.35, 0.35, 0.38));
        commands.spawn((load, FollowParticle::last(rope)));
    }
}

/// Lays a rope in a knot once it has been built.
fn lay(mut ropes: Query<(Entity, &mut Particles), With<Straight>>, mut commands: Commands) {
    for (rope, mut particles) in &mut ropes {
        let (start, last) = (particles.position(0), particles.len() - 1);
        let length = particles.position(last).distance(start);
        for (i, place) in overhand_knot(length, particles.len()).into_iter().enumerate() {
            particles.set_position(i, start + place);
        }
        commands.entity(rope).remove::<Straight>();
    }
}

/// As many points at even distances along a loose overhand knot, whose ends lie apart along Y: the polynomial trefoil of
/// Shastri 1992, "Polynomial representations of knots".
fn overhand_knot(length: f32, points: usize) -> Vec<Vec3> {
    let curve =
        |t: f32| Vec3::new(t.powi(3) - 3.0 * t, -0.25 * (t.powi(5) - 10.0 * t), t.powi(4) - 4.0 * t * t);
    let fine: Vec<Vec3> = (-2400..=2400).map(|i| curve(i as f32 * 1e-3)).collect();
    let mut ways = vec![0.0];
    for pair in fine.windows(2) {
        ways.push(ways[ways.len() - 1] + pair[0].distance(pair[1]));
    }
    let whole = ways[ways.len() - 1];
    let at = |part: f32| fine[ways.partition_point(|way| *way < part * whole).min(fine.len() - 1)];
    (0..points).map(|i| (at(i as f32 / (points - 1) as f32) - fine[0]) * (length / whole)).collect()
}
