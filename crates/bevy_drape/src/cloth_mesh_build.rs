//! Builds cloths from meshes, and hangs the meshes on them.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::{DynamicSkinnedMeshBounds, NoAutoAabb};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use drape_solver::MeshCloth;

use crate::cloth_mesh::{ClothMesh, WeldedVertices};
use crate::cloth_mesh_skin::ClothSkin;
use crate::description::{insert_body, remove_body};
use crate::mesh_reading::{MeshFault, faces, positions};
use crate::moved_by_frame::MovedByFrame;
use crate::particles::{BodyState, CreationOrder, Particles};
use crate::posed::AnimatedPose;
use crate::refusal::Refusals;
use crate::scan::collect_changed;
use crate::surface::{EntitySpace, Surface};
use crate::vertex_map::VertexMap;

/// The mesh that a cloth was made of, which stays as it is, and the copy that shows the cloth.
#[derive(Component, Clone, Debug)]
pub(crate) struct MeshOfCloth {
    source: Handle<Mesh>,
    /// None if the source is no cloth.
    shown: Option<AssetId<Mesh>>,
}

/// The skin that a cloth follows. A renderer refuses to draw a [`SkinnedMesh`] whose mesh has no joints, as the shown copy has none.
#[derive(Component, Clone, Debug)]
pub(crate) struct SkinOfCloth(SkinnedMesh);

/// Builds what was inserted or changed since the last step, what was given another mesh or skin, and what waited for its mesh.
pub(crate) fn build_cloth_meshes(
    mut commands: Commands,
    components: Query<(Entity, Ref<ClothMesh>)>,
    given: Query<(Entity, Ref<Mesh3d>), With<ClothMesh>>,
    not_built: Query<(Entity, Ref<GlobalTransform>), (With<ClothMesh>, Without<Particles>)>,
    skins: Query<(Entity, Ref<SkinnedMesh>), With<ClothMesh>>,
    cloths: Query<(
        &ClothMesh,
        &Mesh3d,
        &GlobalTransform,
        Option<&MeshOfCloth>,
        Option<&SkinnedMesh>,
        Option<&SkinOfCloth>,
    )>,
    places: Query<&GlobalTransform>,
    bind_poses: Option<Res<Assets<SkinnedMeshInverseBindposes>>>,
    made: Query<(Entity, &MeshOfCloth)>,
    mut changes: MessageReader<AssetEvent<Mesh>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut order: ResMut<CreationOrder>,
    mut refusals: ResMut<Refusals>,
    mut to_build: Local<Vec<Entity>>,
) {
    // What waits for its mesh is in the list still.
    collect_changed(&components, &mut to_build);
    collect_changed(&not_built, &mut to_build);
    collect_changed(&skins, &mut to_build);
    let mut swapped = Vec::new();
    collect_changed(&given, &mut swapped);
    swapped.retain(|&entity| {
        let shown = made.get(entity).ok().and_then(|(_, mesh)| mesh.shown);
        given.get(entity).is_ok_and(|(_, mesh)| Some(mesh.id()) != shown)
    });
    to_build.append(&mut swapped);
    for change in changes.read() {
        if let AssetEvent::Modified { id } = change {
            to_build
                .extend(made.iter().filter(|(_, mesh)| mesh.source.id() == *id).map(|(entity, _)| entity));
        }
    }
    let mut later = Vec::new();
    let mut seen = Vec::new();
    for entity in to_build.drain(..) {
        let Ok((cloth, mesh, transform, made, skinned, taken)) = cloths.get(entity) else { continue };
        let skinned = skinned.or(taken.map(|taken| &taken.0));
        if seen.contains(&entity) {
            continue;
        }
        seen.push(entity);
        let source = match made {
            Some(made) if made.shown == Some(mesh.id()) => made.source.clone(),
            _ => mesh.0.clone(),
        };
        let Some(asset) = meshes.get(&source) else {
            later.push(entity);
            continue;
        };
        let fault = |fault| ("ClothMesh", format!("{}: {fault}", called(&source)));
        let place = |joint| places.get(joint).ok();
        let mut is_skinned = false;
        let built = if transform.affine().is_finite() {
            match ClothSkin::read(entity, asset, skinned, bind_poses.as_deref(), place) {
                Ok(None) => {
                    later.push(entity);
                    continue;
                }
                Err(wrong) => Err(fault(wrong)),
                Ok(Some(skin)) => {
                    is_skinned = skin.is_skinned();
                    build(cloth, asset, transform, skin).map_err(fault)
                }
            }
        } else {
            Err(("Transform", "it must be finite".into()))
        };
        match built {
            Ok((cloth, pose, mut surface, mut copy)) => {
                refusals.forget(entity);
                if !cloth.repairs.is_empty() {
                    warn!("ClothMesh of entity {entity}, {}: {}", called(&source), cloth.repairs);
                }
                let bounds =
                    EntitySpace::new(transform).and_then(|space| surface.write(&mut copy, &space, 1.0));
                let welded = WeldedVertices::new(
                    surface.vertices().map(|vertices| vertices.particles.clone()).unwrap_or_default(),
                    cloth.repairs,
                );
                let shown = meshes.add(copy);
                surface.mesh = shown.id();
                let state = MeshOfCloth { source, shown: Some(shown.id()) };
                insert_body(
                    &mut commands,
                    entity,
                    order.next(),
                    transform,
                    (cloth.particles, surface.topology.clone()),
                );
                let bounds = bounds.unwrap_or_default();
                hang_on_pose(&mut commands, entity, pose, is_skinned);
                if let Some(skin) = skinned {
                    commands.entity(entity).remove::<SkinnedMesh>().insert(SkinOfCloth(skin.clone()));
                }
                commands.entity(entity).insert((Mesh3d(shown), state, surface, welded, NoAutoAabb, bounds));
            }
            Err((component, reason)) => {
                refusals.entity(entity, component, reason);
                remove_body(&mut commands, entity);
                commands.entity(entity).remove::<(Surface, WeldedVertices, AnimatedPose)>();
                commands.entity(entity).insert(MeshOfCloth { source, shown: None });
            }
        }
    }
    to_build.append(&mut later);
}

/// The cloth of a mesh, what is known of its surface, and the mesh that will show it.
fn build(
    cloth: &ClothMesh,
    mesh: &Mesh,
    transform: &GlobalTransform,
    skin: ClothSkin,
) -> Result<(MeshCloth, Option<AnimatedPose>, Surface, Mesh), MeshFault> {
    let (built, pose) = skin.build(cloth, mesh, transform)?;
    let places = positions(mesh)?;
    let normals = mesh.try_attribute_option(Mesh::ATTRIBUTE_NORMAL).ok().flatten();
    let normals =
        normals.and_then(VertexAttributeValues::as_float3).filter(|normals| normals.len() == places.len());
    let faces = faces(mesh, places.len())?;
    let mut copy = if mesh.primitive_topology() == PrimitiveTopology::TriangleList {
        mesh.clone()
    } else {
        list_of_triangles(mesh, &faces)
    };
    // What is simulated is not to be skinned again.
    copy.remove_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
    copy.remove_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
    if normals.is_none() {
        copy.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; places.len()]);
    }
    let vertices = VertexMap::new(built.particle_of_vertex.clone(), places, normals, faces);
    // Written here, read by the renderer.
    copy.asset_usage = RenderAssetUsages::MAIN_WORLD | RenderAssetUsages::RENDER_WORLD;
    let surface = Surface::of_mesh(&built.particles, &built.topology.clone().into(), vertices);
    Ok((built, pose, surface, copy))
}

/// Has a new cloth follow its animation, if it has one.
fn hang_on_pose(commands: &mut Commands, entity: Entity, pose: Option<AnimatedPose>, is_skinned: bool) {
    let mut cloth = commands.entity(entity);
    let Some(pose) = pose else {
        cloth.remove::<AnimatedPose>();
        return;
    };
    if is_skinned {
        // Bounds are those of the simulated mesh, and pins follow the joints instead of the entity.
        cloth.remove::<DynamicSkinnedMeshBounds>();
        cloth.entry::<BodyState>().and_modify(|mut state| state.pins.clear());
        let joints = pose.joints.clone();
        cloth.insert(pose);
        for joint in joints {
            commands.entity(joint).insert_if_new(MovedByFrame);
        }
    } else {
        cloth.insert(pose);
    }
}

/// A strip as a list, which can be torn.
fn list_of_triangles(strip: &Mesh, faces: &[[u32; 3]]) -> Mesh {
    let mut list = Mesh::new(PrimitiveTopology::TriangleList, strip.asset_usage);
    for (&attribute, values) in strip.attributes() {
        list.insert_attribute(attribute, values.clone());
    }
    list.with_inserted_indices(Indices::U32(faces.as_flattened().to_vec()))
}

/// A mesh by the path that it was loaded from.
fn called(mesh: &Handle<Mesh>) -> String {
    mesh.path().map_or_else(|| "a mesh made in code".into(), |path| format!("mesh “{path}”"))
}

/// Takes off an entity that loses its [`ClothMesh`] what was put there besides the body. The mesh stays as it is.
pub(crate) fn remove_mesh_of_cloth(removed: On<Remove, ClothMesh>, mut commands: Commands) {
    commands
        .entity(removed.entity)
        .try_remove::<(Surface, WeldedVertices, MeshOfCloth, SkinOfCloth, AnimatedPose)>();
}
