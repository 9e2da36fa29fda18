//! Meshes and materials of the scene, in a window and in pictures.
//!
//! The scene itself does not depend on this: observers add meshes and materials to new entities.

use core::f32::consts::FRAC_PI_2;

use bevy::prelude::*;

use crate::cannon_demo::scene::{CURTAIN_SIZE, Curtain, Ground, curtain_clearance};
use crate::view::lighting::LightingPlugin;
use crate::view::shared_materials::{EARTH, SharedMaterials, SharedMaterialsPlugin};

/// Adds meshes and materials to the scene of the cannon demo.
pub struct CannonMaterialsPlugin;

impl Plugin for CannonMaterialsPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((LightingPlugin, SharedMaterialsPlugin))
            .add_systems(Startup, spawn_frame)
            .add_observer(add_curtain_material)
            .add_observer(add_ground_mesh);
    }
}

/// Rod and posts that the curtain hangs from. Nothing touches them.
fn spawn_frame(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let material = materials.add(StandardMaterial {
        base_color: Color::srgb(0.30, 0.20, 0.13),
        perceptual_roughness: 0.6,
        ..default()
    });
    let (half_width, top) = (0.5 * CURTAIN_SIZE.x + 0.2, curtain_clearance() + CURTAIN_SIZE.y + 0.02);
    let mut spawn = |mesh: Mesh, transform: Transform| {
        commands.spawn((Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()), transform));
    };
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    spawn(
        Cylinder::new(0.03, 2.0 * half_width + 0.2).mesh().build(),
        Transform::from_xyz(0.0, top, 0.0).with_rotation(lying),
    );
    for side in [-1.0, 1.0] {
        let x = side * half_width;
        spawn(Cylinder::new(0.05, top).mesh().build(), Transform::from_xyz(x, 0.5 * top, 0.0));
        spawn(Cylinder::new(0.16, 0.08).mesh().build(), Transform::from_xyz(x, 0.04, 0.0));
        let knob = x + side * 0.12;
        spawn(Sphere::new(0.06).mesh().uv(24, 16), Transform::from_xyz(knob, top, 0.0));
    }
}

fn add_curtain_material(added: On<Add<Curtain>>, mut commands: Commands, shared: Res<SharedMaterials>) {
    commands.entity(added.entity).insert(MeshMaterial3d(shared.fabric.clone()));
}

fn add_ground_mesh(
    added: On<Add<Ground>>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let material =
        StandardMaterial { base_color: EARTH, perceptual_roughness: 0.95, reflectance: 0.1, ..default() };
    commands.entity(added.entity).insert((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(600.0, 600.0))),
        MeshMaterial3d(materials.add(material)),
    ));
}
