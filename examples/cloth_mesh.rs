//! Cloth from any mesh: a cone becomes a skirt that hangs by its waist.
//!
//! `cargo run --release --example cloth_mesh --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A skirt from a mesh, on a figure that turns",
    controls: "",
    eye: Vec3::new(0.8, 1.25, 2.6),
    target: Vec3::new(0.0, 0.85, 0.0),
    picture_time: 2.0,
    build: |app| {
        app.add_systems(FixedUpdate, turn).add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Greatest speed of turning, in radians per second.
const TURN: f32 = 6.0;

#[derive(Component)]
struct Skirt;

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    commands.spawn(Obstacle::ground());
    let mesh = ConicalFrustum { radius_top: 0.18, radius_bottom: 0.55, height: 0.6 };
    let mut mesh = mesh.mesh().resolution(72).segments(24).build();
    mesh.remove_attribute(Mesh::ATTRIBUTE_NORMAL);
    let mesh = without_caps(mesh);
    // The waist is what lies at the top.
    let waist = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|places| places.as_float3());
    let is_top = |place: &[f32; 3]| place[1] > 0.295;
    let pins = waist.into_iter().flatten().enumerate().filter(|(_, place)| is_top(place));
    let skirt = ClothMesh::default().with_pins(pins.map(|(i, _)| i as u32));
    let skirt = (skirt, Fabric { bend_stiffness: 0.02, ..default() });
    let place = Transform::from_xyz(0.0, 1.0, 0.0);
    // A skirt lies in folds until the turn spreads it.
    let settings = SolverSettings { self_contact: SelfContact::On, ..default() };
    commands.spawn((Skirt, Mesh3d(meshes.add(mesh)), skirt, settings, Paint::rgb(0.55, 0.18, 0.40), place));
    for side in [-0.09, 0.09] {
        commands.spawn((Obstacle::capsule(0.07, 0.85), Transform::from_xyz(side, 0.6, 0.0)));
    }
    commands.spawn((Obstacle::capsule(0.16, 0.35), Transform::from_xyz(0.0, 1.38, 0.0)));
}

/// Only the side of the frustum: the first rows of its vertices.
fn without_caps(mut mesh: Mesh) -> Mesh {
    let side = 24 * 72 * 6;
    if let Some(bevy::mesh::Indices::U32(indices)) = mesh.indices_mut() {
        indices.truncate(side);
    }
    mesh
}

fn turn(clock: Res<Time<Fixed>>, mut skirts: Query<&mut Transform, With<Skirt>>) {
    let speed = TURN * (clock.elapsed_secs() * 0.8).min(1.0);
    for mut place in &mut skirts {
        place.rotate_y(speed * clock.delta_secs());
    }
}
