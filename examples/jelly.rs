//! Soft solids: jelly cubes, a ring and a many-cornered drop on few cells fall onto steps, and wobble to rest.
//!
//! `cargo run --release --example jelly --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::render::DrivenMesh;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Jellies on a flight of steps",
    controls: "",
    eye: Vec3::new(2.1, 1.7, 2.9),
    target: Vec3::new(-0.05, 0.45, 0.0),
    picture_time: 0.95,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Height and depth of a step in metres.
const HEIGHT: f32 = 0.25;
const DEPTH: f32 = 0.6;

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    commands.spawn(Obstacle::ground());
    for step in 0..3_u8 {
        let height = HEIGHT * f32::from(3 - step);
        let place = Vec3::new(DEPTH * (f32::from(step) - 1.5), 0.5 * height, 0.0);
        commands.spawn((Obstacle::cuboid(DEPTH, height, 3.0), Transform::from_translation(place)));
    }
    let jelly = SoftBodyMesh { stiffness: 0.4, ..default() };
    let cube = meshes.add(rounded_cube());
    for (place, turn, paint) in [
        (Vec3::new(-0.85, 1.5, 0.7), 0.2, Paint::rgb(0.85, 0.25, 0.35)),
        (Vec3::new(-0.4, 1.4, -0.15), 0.5, Paint::rgb(0.95, 0.70, 0.25)),
        (Vec3::new(0.15, 1.2, 0.75), -0.4, Paint::rgb(0.35, 0.65, 0.40)),
    ] {
        let turned = Quat::from_euler(EulerRot::XYZ, turn, 2.0 * turn, 0.3);
        let place = Transform::from_translation(place).with_rotation(turned);
        commands.spawn((Mesh3d(cube.clone()), jelly.clone(), paint, place));
    }
    let ring = meshes.add(Torus { minor_radius: 0.1, major_radius: 0.26 });
    let place = Transform::from_xyz(0.1, 1.1, -0.1).with_rotation(Quat::from_rotation_z(0.9));
    let soft = SoftBodyMesh { spacing: Some(0.075), stiffness: 0.9, ..default() };
    commands.spawn((Mesh3d(ring), soft, Paint::rgb(0.30, 0.45, 0.80), place));
    // A fine mesh is drawn; a coarse ball without paint is solved, and its cells carry the mesh.
    let coarse = meshes.add(Sphere::new(0.24).mesh().uv(16, 10));
    let fine = meshes.add(pudding());
    let place = Transform::from_xyz(-0.95, 1.25, -0.75);
    let driver = commands.spawn((Mesh3d(coarse), jelly, place)).id();
    commands.spawn((Mesh3d(fine), DrivenMesh { driver }, Paint::rgb(0.60, 0.35, 0.65), place));
}

/// A cube whose edges and corners are round: the sphere of the norm of order eight.
fn rounded_cube() -> Mesh {
    shaped_ball(1.0, [48, 32], |place| {
        let sum = place.to_array().map(|part| part.powi(8)).iter().sum::<f32>();
        place * (0.18 / libm::powf(sum, 0.125))
    })
}

/// A ball with twelve grooves.
fn pudding() -> Mesh {
    shaped_ball(0.24, [144, 48], |place| {
        let groove = 1.0 + 0.05 * libm::cosf(12.0 * libm::atan2f(place.y, place.x));
        place * Vec3::new(groove, groove, 1.0)
    })
}

/// A ball of so many sectors and stacks whose vertices are moved.
fn shaped_ball(radius: f32, [sectors, stacks]: [u32; 2], moved: impl Fn(Vec3) -> Vec3) -> Mesh {
    let mut mesh = Sphere::new(radius).mesh().uv(sectors, stacks);
    let places = mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION);
    if let Some(bevy::mesh::VertexAttributeValues::Float32x3(places)) = places {
        places.iter_mut().for_each(|place| *place = moved(Vec3::from(*place)).to_array());
    }
    // Without normals of its own it is smooth all over, seam and all.
    mesh.remove_attribute(Mesh::ATTRIBUTE_NORMAL);
    mesh
}
