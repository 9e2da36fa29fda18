//! A rope whose ends are tied to other entities, and entities that are tied to the rope.
//!
//! `cargo run --release --example lamps --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Lamps on a rope between two boats",
    controls: "",
    eye: Vec3::new(1.2, 1.3, 3.95),
    target: Vec3::new(0.05, 0.85, 0.0),
    picture_time: 2.4,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(FixedUpdate, float);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Height of a mast in metres.
const MAST: f32 = 1.6;
/// Greatest distance of each boat from the middle in metres. The rope is just as long.
const FARTHEST: f32 = 1.9;
/// Particles of the rope.
const PARTICLES: u32 = 61;

/// A boat, on the left (-1) or on the right (1).
#[derive(Component)]
struct Boat(f32);

fn setup(mut commands: Commands) {
    commands.spawn((Obstacle::ground(), Paint::rgb(0.10, 0.24, 0.32)));
    let [left, right] = [-1.0, 1.0].map(|side| {
        let hull = (Obstacle::cuboid(1.0, 0.3, 0.4), Paint::rgb(0.55, 0.22, 0.16));
        let boat = commands.spawn((Boat(side), hull, place_of(side, 0.0))).id();
        let mast = (Obstacle::capsule(0.025, MAST), Paint::rgb(0.60, 0.46, 0.30));
        commands.spawn((mast, Transform::from_xyz(0.0, 0.5 * MAST, 0.0), ChildOf(boat)));
        boat
    });
    let end = |side: f32| place_of(side, 0.0).transform_point(Vec3::Y * (MAST + 0.05));
    let rope = Rope { linear_density: 0.4, ..Rope::new(end(-1.0), end(1.0), PARTICLES) };
    let ties = Attachment::first(left).and(Tie::last(right));
    let rope = commands.spawn((rope, ties, RopeMesh::new(0.012), Paint::rgb(0.30, 0.26, 0.22))).id();
    for particle in (6..PARTICLES - 1).step_by(8) {
        // Only to look at: they touch nothing.
        let lamp = (Obstacle::sphere(0.07), DrapeLayers::new(0, 0), Paint::rgb(1.0, 0.82, 0.35));
        let follow = FollowParticle::index(rope, particle).with_offset(Vec3::NEG_Y * 0.08);
        commands.spawn((lamp, follow));
    }
}

/// The place of a boat, which rolls, rises and drifts.
fn place_of(side: f32, seconds: f32) -> Transform {
    let x = side * (FARTHEST - 0.12 * (1.0 - seconds.cos()));
    let y = 0.02 + 0.10 * (1.6 * seconds).sin() * side;
    let roll = 0.12 * (1.6 * seconds).sin();
    Transform::from_xyz(x, y, 0.0).with_rotation(Quat::from_rotation_z(roll))
}

fn float(time: Res<Time>, mut boats: Query<(&Boat, &mut Transform)>) {
    for (boat, mut transform) in &mut boats {
        *transform = place_of(boat.0, time.elapsed_secs());
    }
}
