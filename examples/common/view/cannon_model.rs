//! A cannon to look at, built from Bevy's primitives.
//!
//! The entity with the [`Cannon`] is the muzzle; the barrel reaches back from it and turns about it, and the
//! carriage stands under the barrel's trunnions.

use core::f32::consts::{FRAC_PI_2, TAU};

use bevy::prelude::*;
use bevy_drape::cannon::Cannon;

/// From the muzzle back to the trunnions, about which a real barrel turns, in metres.
const TRUNNION: f32 = 0.55;
const BARREL_LENGTH: f32 = 1.25;
const WHEEL_RADIUS: f32 = 0.48;
const SPOKES: u32 = 10;

/// The barrel of the cannon that is its parent.
#[derive(Component)]
pub(crate) struct Barrel;

/// The carriage of the cannon that is its parent.
#[derive(Component)]
pub(crate) struct Carriage;

/// Materials of the parts.
struct CannonMaterials {
    iron: Handle<StandardMaterial>,
    bore: Handle<StandardMaterial>,
    wood: Handle<StandardMaterial>,
    brass: Handle<StandardMaterial>,
}

/// Gives a new cannon its model.
pub(crate) fn build_cannon(
    added: On<Add<Cannon>>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut material = |colour: Color, metallic: f32, perceptual_roughness: f32| {
        materials.add(StandardMaterial { base_color: colour, metallic, perceptual_roughness, ..default() })
    };
    let stuff = CannonMaterials {
        iron: material(Color::srgb(0.17, 0.18, 0.20), 0.5, 0.45),
        bore: material(Color::srgb(0.02, 0.02, 0.02), 0.0, 1.0),
        wood: material(Color::srgb(0.45, 0.28, 0.15), 0.0, 0.8),
        brass: material(Color::srgb(0.80, 0.58, 0.25), 0.6, 0.35),
    };
    let mut part = |mesh: Mesh, material: &Handle<StandardMaterial>, transform: Transform| {
        (Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()), transform)
    };
    let barrel = barrel(&stuff, &mut part);
    let carriage = carriage(&stuff, &mut part);
    commands.entity(added.entity).insert(Visibility::default());
    for (parts, is_barrel) in [(barrel, true), (carriage, false)] {
        let mut node = commands.spawn((ChildOf(added.entity), Transform::default(), Visibility::default()));
        if is_barrel {
            node.insert(Barrel);
        } else {
            node.insert(Carriage);
        }
        node.with_children(|node| {
            for part in parts {
                node.spawn(part);
            }
        });
    }
}

type Part = (Mesh3d, MeshMaterial3d<StandardMaterial>, Transform);

/// The barrel, from the muzzle in the origin along +Z.
fn barrel(
    stuff: &CannonMaterials,
    part: &mut impl FnMut(Mesh, &Handle<StandardMaterial>, Transform) -> Part,
) -> Vec<Part> {
    // Cylinders stand along Y: laid down, their top is at the breech.
    let lying = |z: f32| Transform::from_xyz(0.0, 0.0, z).with_rotation(Quat::from_rotation_x(FRAC_PI_2));
    let ring = |radius: f32, width: f32| Cylinder::new(radius, width).mesh().resolution(40).build();
    let tube = ConicalFrustum { radius_top: 0.27, radius_bottom: 0.2, height: BARREL_LENGTH };
    let sphere = |radius: f32| Sphere::new(radius).mesh().uv(40, 24);
    vec![
        part(tube.mesh().resolution(40).build(), &stuff.iron, lying(0.5 * BARREL_LENGTH)),
        part(ring(0.235, 0.09), &stuff.iron, lying(0.045)),
        part(ring(0.16, 0.02), &stuff.bore, lying(-0.004)),
        part(ring(0.232, 0.04), &stuff.brass, lying(0.36)),
        part(ring(0.265, 0.05), &stuff.brass, lying(0.82)),
        part(ring(0.29, 0.07), &stuff.iron, lying(BARREL_LENGTH)),
        part(sphere(0.265), &stuff.iron, Transform::from_xyz(0.0, 0.0, BARREL_LENGTH)),
        part(sphere(0.075), &stuff.brass, Transform::from_xyz(0.0, 0.0, BARREL_LENGTH + 0.3)),
        part(
            Cylinder::new(0.06, 0.76).mesh().build(),
            &stuff.brass,
            Transform::from_xyz(0.0, 0.0, TRUNNION).with_rotation(Quat::from_rotation_z(FRAC_PI_2)),
        ),
    ]
}

/// The carriage: trunnions above the origin, which is on the ground.
fn carriage(
    stuff: &CannonMaterials,
    part: &mut impl FnMut(Mesh, &Handle<StandardMaterial>, Transform) -> Part,
) -> Vec<Part> {
    let mut parts = Vec::new();
    for side in [-1.0, 1.0] {
        let cheek = Cuboid::new(0.07, 0.62, 0.55).mesh().build();
        parts.push(part(cheek, &stuff.wood, Transform::from_xyz(0.34 * side, 0.68, 0.0)));
        let trail = Cuboid::new(0.09, 0.16, 2.1).mesh().build();
        let tilt = Quat::from_rotation_x(0.26);
        let place = Transform::from_xyz(0.34 * side, 0.34, 1.0).with_rotation(tilt);
        parts.push(part(trail, &stuff.wood, place));
        let hub = Transform::from_xyz(0.47 * side, WHEEL_RADIUS, 0.0);
        let across = Quat::from_rotation_z(FRAC_PI_2);
        let rim = Torus { minor_radius: 0.05, major_radius: WHEEL_RADIUS - 0.05 }.mesh().build();
        parts.push(part(rim, &stuff.wood, hub.with_rotation(across)));
        let nave = Cylinder::new(0.085, 0.16).mesh().build();
        parts.push(part(nave, &stuff.iron, hub.with_rotation(across)));
        for spoke in 0..SPOKES {
            let turn = Quat::from_rotation_x(TAU * spoke as f32 / SPOKES as f32);
            let bar = Cuboid::new(0.045, WHEEL_RADIUS - 0.08, 0.05).mesh().build();
            let middle = turn * Vec3::Y * (0.5 * (WHEEL_RADIUS - 0.04));
            let place = Transform::from_translation(hub.translation + middle).with_rotation(turn);
            parts.push(part(bar, &stuff.wood, place));
        }
    }
    let axle = Cylinder::new(0.05, 0.94).mesh().build();
    let across = Quat::from_rotation_z(FRAC_PI_2);
    parts.push(part(axle, &stuff.iron, Transform::from_xyz(0.0, WHEEL_RADIUS, 0.0).with_rotation(across)));
    for (y, z) in [(0.52, 0.35), (0.14, 1.75)] {
        let transom = Cuboid::new(0.6, 0.1, 0.12).mesh().build();
        parts.push(part(transom, &stuff.wood, Transform::from_xyz(0.0, y, z)));
    }
    parts
}

/// Turns barrel and carriage to where the cannon aims.
pub(crate) fn aim_model(
    cannons: Query<(&Cannon, &Transform, &Children), Or<(Changed<Cannon>, Changed<Children>)>>,
    mut barrels: Query<&mut Transform, (With<Barrel>, Without<Cannon>)>,
    mut carriages: Query<&mut Transform, (With<Carriage>, Without<Barrel>, Without<Cannon>)>,
) {
    for (cannon, transform, children) in &cannons {
        let turn = Quat::from_rotation_y(cannon.azimuth);
        for child in children.iter() {
            if let Ok(mut barrel) = barrels.get_mut(child) {
                barrel.rotation = turn * Quat::from_rotation_x(cannon.elevation);
            }
            if let Ok(mut carriage) = carriages.get_mut(child) {
                let trunnion = turn * Vec3::Z * (TRUNNION * cannon.elevation.cos());
                carriage.translation = trunnion - Vec3::Y * transform.translation.y;
                carriage.rotation = turn;
            }
        }
    }
}
