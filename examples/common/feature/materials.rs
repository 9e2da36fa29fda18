//! Meshes and materials of an example's bodies and obstacles, in the colours of their [`Paint`].

use core::f32::consts::FRAC_PI_2;

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_drape::build::RigidTetrahedron;
use bevy_drape::prelude::*;
use bevy_drape::render::DrivenMesh;
use bevy_drape_script::recording::Form;
use drape_solver::parry3d::shape::{SharedShape, TypedShape};
use drape_solver::{Placement, Shape};

use crate::feature::surfaces::{Surfaces, jelly};
use crate::view::lighting::LightingPlugin;
use crate::view::paint::Paint;
use crate::view::shape_meshes::{Placed, flat, material_of, mesh_of};
use crate::view::shared_materials::{SharedMaterials, SharedMaterialsPlugin};
use crate::view::tubes::TubesPlugin;

/// Colour of obstacles that have no paint, but for the ground.
const SOLID: Color = Color::srgb(0.45, 0.52, 0.58);
/// Colour of the ground that has no paint.
const STONE: Color = Color::srgb(0.56, 0.54, 0.50);
/// Pieces that a round shape is made of, all the way round.
const ROUNDNESS: u32 = 48;

/// Adds meshes and materials to the bodies and obstacles of an example.
pub struct FeatureMaterialsPlugin;

impl Plugin for FeatureMaterialsPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((LightingPlugin, SharedMaterialsPlugin, TubesPlugin))
            .init_resource::<Surfaces>()
            .add_systems(
                Update,
                (add_body_materials, add_obstacle_meshes, add_rigid_meshes, add_rails, repaint),
            );
    }
}

type Bare = (
    Without<MeshMaterial3d<StandardMaterial>>,
    Or<(
        With<Cloth>,
        With<ClothMesh>,
        With<SoftBall>,
        With<RopeMesh>,
        With<DrivenMesh>,
        // Hair and skirts of bones.
        (With<SkinnedMesh>, With<Paint>),
        // Those without paint drive others.
        (With<SoftBodyMesh>, With<Paint>),
    )>,
);

fn add_body_materials(
    bodies: Query<
        (
            (Entity, Option<&Paint>, Option<(&Rope, &RopeMesh)>),
            (Has<Cloth>, Has<ClothMesh>, Has<SkinnedMesh>, Has<SoftBall>),
        ),
        Bare,
    >,
    shared: Res<SharedMaterials>,
    surfaces: Res<Surfaces>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for ((entity, paint, rope), (is_cloth, is_cloth_mesh, is_skinned, is_soft_ball)) in &bodies {
        let painted = paint.map(|paint| {
            let colour = paint.color();
            materials.add(match rope {
                Some((rope, tube)) => surfaces.rope(colour, rope, tube),
                None if is_cloth => surfaces.cloth(colour),
                None if is_cloth_mesh || is_skinned => surfaces.cloth_mesh(colour),
                None if is_soft_ball => surfaces.soft_ball(colour),
                None => jelly(colour),
            })
        });
        let fabric = painted.unwrap_or(shared.fabric.clone());
        commands.entity(entity).insert(MeshMaterial3d(fabric));
    }
}

/// Follows changes of [`Paint`].
fn repaint(
    bodies: Query<(&Paint, &MeshMaterial3d<StandardMaterial>), Changed<Paint>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (paint, material) in &bodies {
        if let Some(mut material) = materials.get_mut(material) {
            material.base_color = paint.color();
        }
    }
}

type BareRigid = (Without<HasMeshes>, With<Particles>);

/// Draws a rigid body as the convex hull of its corners.
fn add_rigid_meshes(
    bodies: Query<(Entity, &RigidTetrahedron, Option<&Paint>), BareRigid>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, body, paint) in &bodies {
        let mut parent = commands.entity(entity);
        parent.insert((HasMeshes, Interpolated)).insert_if_new(Visibility::default());
        let hull = SharedShape::convex_hull(&body.corners).and_then(|hull| round(&Shape::Parry(hull)));
        if let Some(mesh) = hull {
            let colour = paint.map_or(SOLID, Paint::color);
            let material = StandardMaterial { base_color: colour, perceptual_roughness: 0.8, ..default() };
            parent.with_child((Mesh3d(meshes.add(mesh)), MeshMaterial3d(materials.add(material))));
        }
    }
}

/// Marks an obstacle or rigid body that has its meshes.
#[derive(Component)]
struct HasMeshes;

fn add_obstacle_meshes(
    obstacles: Query<(Entity, &Obstacle, Option<&Paint>), (Without<HasMeshes>, Without<Mesh3d>)>,
    surfaces: Res<Surfaces>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, obstacle, paint) in &obstacles {
        let mut parent = commands.entity(entity);
        parent.insert((HasMeshes, Interpolated)).insert_if_new(Visibility::default());
        // Sensors are not drawn.
        if obstacle.is_sensor {
            continue;
        }
        let Ok(Some(whole)) = obstacle.shape.solid(None) else { continue };
        for (shape, at) in parts(&whole) {
            let (looks, form): (Option<Placed>, Form) = match round(shape) {
                Some(mesh) => (Some((mesh, Transform::IDENTITY)), Form::Sphere { radius: 1.0 }),
                None => {
                    let form = Form::of(shape);
                    (mesh_of(form), form)
                }
            };
            let material = match (form, paint) {
                (Form::HalfSpace { .. }, None) => surfaces.ground(STONE),
                (Form::HalfSpace { .. }, Some(paint)) => surfaces.water(paint.color()),
                _ => material_of(form, paint.map_or(SOLID, Paint::color)),
            };
            if let Some((mesh, place)) = looks {
                parent.with_child((
                    Mesh3d(meshes.add(mesh)),
                    MeshMaterial3d(materials.add(material)),
                    at * place,
                ));
            }
        }
    }
}

/// Length of the cords of a rail in metres.
const CORD: f32 = 10.0;

/// Marks cloth that has been looked at for a rail.
#[derive(Component)]
struct IsHung;

/// Draws the rail that a curtain hangs from, and the two cords that hold it. Where there are ropes, it hangs from what the scene has.
fn add_rails(
    cloths: Query<(Entity, &Cloth), Without<IsHung>>,
    ropes: Query<(), With<Rope>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, cloth) in &cloths {
        let mut parent = commands.entity(entity);
        parent.insert(IsHung);
        if cloth.pins != ClothPins::Top || !ropes.is_empty() {
            continue;
        }
        let radius = (0.012 * cloth.size.x).clamp(0.008, 0.02);
        let rail = Capsule3d::new(radius, cloth.size.x + 6.0 * radius).mesh().build();
        let iron = StandardMaterial {
            base_color: Color::srgb(0.36, 0.33, 0.30),
            metallic: 0.4,
            perceptual_roughness: 0.45,
            ..default()
        };
        let along_top =
            Transform::from_xyz(0.0, 0.5 * cloth.size.y, 0.0).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
        // They end above the picture.
        let cord = Mesh3d(meshes.add(Cylinder::new(0.3 * radius, CORD).mesh().resolution(8)));
        let iron = MeshMaterial3d(materials.add(iron));
        let above = 0.5 * (cloth.size.y + CORD);
        let [left, right] = [-0.4, 0.4].map(|part| Transform::from_xyz(part * cloth.size.x, above, 0.0));
        parent
            .with_child((Mesh3d(meshes.add(rail)), iron.clone(), along_top))
            .with_child((cord.clone(), iron.clone(), left))
            .with_child((cord, iron, right));
    }
}

/// The shapes that a shape is made of, with their places.
fn parts(shape: &Shape) -> Vec<(&Shape, Transform)> {
    let Shape::Compound(compound) = shape else { return vec![(shape, Transform::IDENTITY)] };
    let place =
        |place: Placement| Transform::from_translation(place.translation).with_rotation(place.rotation);
    compound.parts().map(|(part, at)| (part, place(at))).collect()
}

/// The mesh of a cylinder, cone or convex hull; none for other shapes.
fn round(shape: &Shape) -> Option<Mesh> {
    let Shape::Parry(shape) = shape else { return None };
    let (corners, triangles) = match shape.as_typed_shape() {
        TypedShape::Cylinder(cylinder) => cylinder.to_trimesh(ROUNDNESS),
        TypedShape::Cone(cone) => cone.to_trimesh(ROUNDNESS),
        TypedShape::ConvexPolyhedron(hull) => hull.to_trimesh(),
        _ => return None,
    };
    let corners: Vec<Vec3> = corners.iter().map(|corner| Vec3::new(corner.x, corner.y, corner.z)).collect();
    Some(flat(&corners, &triangles))
}
