//! The sample of the README: a curtain, a ball on its way into it, and the ground.
//!
//! `cargo run --release --example readme --features window`

use bevy::prelude::*;
use bevy_drape::prelude::*;

fn main() {
    App::new().add_plugins((DefaultPlugins, DrapePlugins::default())).add_systems(Startup, setup).run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    // Cloth is seen from both sides.
    let red = StandardMaterial {
        base_color: Color::srgb(0.7, 0.05, 0.05),
        double_sided: true,
        cull_mode: None,
        ..default()
    };
    let grey = materials.add(Color::srgb(0.4, 0.4, 0.4));

    // A curtain of 2 m x 1.5 m, pinned along its top edge. The plugin makes its mesh.
    commands.spawn((
        Cloth::new(2.0, 1.5),
        MeshMaterial3d(materials.add(red)),
        Transform::from_xyz(0.0, 1.5, 0.0),
    ));
    // A ball of 2 kg on its way into the curtain, and the ground.
    commands.spawn((
        Projectile { radius: 0.15, mass: 2.0, velocity: Vec3::new(0.0, 3.0, -8.0), ..default() },
        Interpolated,
        Mesh3d(meshes.add(Sphere::new(0.15))),
        MeshMaterial3d(grey.clone()),
        Transform::from_xyz(0.0, 1.5, 5.0),
    ));
    commands.spawn((
        Obstacle::ground(),
        Mesh3d(meshes.add(Plane3d::default().mesh().size(20.0, 20.0))),
        MeshMaterial3d(grey),
    ));

    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(-2.5, 2.0, 3.5).looking_at(Vec3::new(0.0, 1.2, 0.0), Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(-2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
