//! Builds bodies from the meshes of their entities.

use std::sync::Arc;

use bevy::camera::visibility::{DynamicSkinnedMeshBounds, NoAutoAabb};
use bevy::math::Affine3A;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use drape_solver::{MeshError, Topology};

use crate::attach::animated_pose::AnimatedPose;
use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::fabric::Fabric;
use crate::body::on_gpu::OnGpu;
use crate::body::particles::Particles;
use crate::build::description::{ChangedFabrics, insert_body, remove_body};
use crate::change_detection::collect_changed;
use crate::refusal::{Cause, Refusals};
use crate::render::from_mesh::reading::MeshFault;
use crate::render::from_mesh::skin::ClothSkin;
use crate::render::from_mesh::source::{ChangedMeshes, FaultyMesh, MeshParts, MeshSource, called, show_copy};
use crate::render::surface::Surface;
use crate::render::vertices::Vertices;
use crate::transform::moved_by_frame::MovedByFrame;

/// A component that makes a body from the entity's mesh.
pub(crate) trait MeshDescription: Component {
    /// Name in the log.
    const NAME: &'static str;

    /// Components that the entity gets with body and surface, and loses with them.
    type Parts: Bundle;

    /// True if vertex colours are paint that is read, and must not be drawn.
    fn takes_colours(&self) -> bool {
        false
    }

    /// Builds the body of `mesh`, which has these parts, at `transform`; `fabric` matters to cloths only.
    fn build(
        &self,
        fabric: &Fabric,
        mesh: &Mesh,
        parts: &MeshParts,
        transform: &GlobalTransform,
        skin: ClothSkin,
    ) -> Result<MeshBody<Self::Parts>, MeshFault>;
}

/// The body that a mesh has become.
pub(crate) struct MeshBody<P> {
    pub particles: drape_solver::Particles,
    pub topology: Arc<Topology>,
    pub vertices: Vertices,
    /// Transform from the mesh's coordinates to the rest positions of the particles.
    pub rest: Affine3A,
    pub pose: Option<AnimatedPose>,
    pub parts: P,
    /// Description of the repairs to the mesh, if there were any.
    pub repairs: Option<String>,
}

/// The skin that a body follows. Renderers do not draw a [`SkinnedMesh`] whose mesh has no joints, and the shown copy
/// has none.
#[derive(Component, Clone, Debug)]
pub(crate) struct SkinOfCloth(SkinnedMesh);

/// Entities with a `D`, and everything that their bodies are made from.
type DescribedMeshes<'w, 's, D> = Query<
    'w,
    's,
    (
        &'static D,
        Option<&'static Fabric>,
        &'static Mesh3d,
        &'static GlobalTransform,
        Option<&'static MeshSource>,
        Option<&'static SkinnedMesh>,
        Option<&'static SkinOfCloth>,
    ),
>;

/// Builds bodies whose component, mesh or skin was inserted or changed since the last step, and those that waited for
/// their mesh.
pub(crate) fn build_mesh_bodies<D: MeshDescription>(
    mut commands: Commands,
    mut changed: ChangedMeshes<D>,
    not_built: Query<(Entity, Ref<GlobalTransform>), (With<D>, Without<Particles>, Without<OnGpu>)>,
    skins: Query<(Entity, Ref<SkinnedMesh>), With<D>>,
    fabrics: ChangedFabrics<D>,
    described: DescribedMeshes<D>,
    places: Query<&GlobalTransform>,
    bind_poses: Option<Res<Assets<SkinnedMeshInverseBindposes>>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut order: ResMut<CreationOrder>,
    mut refusals: ResMut<Refusals>,
    mut to_build: Local<Vec<Entity>>,
) {
    // The list still has the entities that wait for their mesh.
    changed.collect(&mut to_build);
    collect_changed(&not_built, &mut to_build);
    collect_changed(&skins, &mut to_build);
    fabrics.collect(&mut to_build);
    let mut later = Vec::new();
    let mut seen = Vec::new();
    for entity in to_build.drain(..) {
        let Ok((description, fabric, mesh, transform, made, skinned, taken)) = described.get(entity) else {
            continue;
        };
        let skinned = skinned.or(taken.map(|taken| &taken.0));
        if seen.contains(&entity) {
            continue;
        }
        seen.push(entity);
        let source = MeshSource::of(mesh, made);
        let Some(asset) = meshes.get(&source) else {
            later.push(entity);
            continue;
        };
        let fault = |fault| {
            let number =
                if let MeshFault::Mesh(MeshError::Build(error)) = &fault { Some(error) } else { None };
            let component = Fabric::or_description(fabric, number, D::NAME);
            (component, Cause::from(FaultyMesh::new(&source, fault)))
        };
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
                    build(description, fabric, asset, transform, skin).map_err(fault)
                }
            }
        } else {
            Err(("Transform", "it must be finite".into()))
        };
        match built {
            Ok((MeshBody { particles, topology, rest, pose, parts, repairs, .. }, surface, copy)) => {
                refusals.forget(entity);
                if let Some(repairs) = repairs {
                    warn!("{} of entity {entity}, {}: {repairs}", D::NAME, called(&source));
                }
                insert_body(&mut commands, entity, order.next(), transform, (particles, topology), fabric);
                commands.entity(entity).entry::<BodyState>().and_modify(move |mut state| state.rest = rest);
                follow_pose(&mut commands, entity, pose, is_skinned);
                let mut body = commands.entity(entity);
                if let Some(skin) = skinned {
                    body.remove::<SkinnedMesh>().insert(SkinOfCloth(skin.clone()));
                }
                body.insert(parts);
                show_copy(&mut body, &mut meshes, transform, source, surface, copy);
            }
            Err((component, reason)) => {
                refusals.entity(entity, component, reason);
                remove_body(&mut commands, entity);
                commands.entity(entity).remove::<(Surface, D::Parts, AnimatedPose)>();
                commands.entity(entity).insert(MeshSource::refused(mesh, made));
            }
        }
    }
    to_build.append(&mut later);
}

/// Builds the body of a mesh, its surface, and the mesh that shows it.
fn build<D: MeshDescription>(
    description: &D,
    fabric: Option<&Fabric>,
    mesh: &Mesh,
    transform: &GlobalTransform,
    skin: ClothSkin,
) -> Result<(MeshBody<D::Parts>, Surface, Mesh), MeshFault> {
    let parts = MeshParts::of(mesh)?;
    let mut body = description.build(&fabric.copied().unwrap_or_default(), mesh, &parts, transform, skin)?;
    let vertices = core::mem::take(&mut body.vertices);
    let surface = Surface::of_mesh(&body.particles, &body.topology, vertices);
    let mut copy = parts.copy_to_show(mesh);
    if description.takes_colours() {
        copy.remove_attribute(Mesh::ATTRIBUTE_COLOR);
    }
    Ok((body, surface, copy))
}

/// Lets a new cloth follow its animation, if it has one.
fn follow_pose(commands: &mut Commands, entity: Entity, pose: Option<AnimatedPose>, is_skinned: bool) {
    let mut cloth = commands.entity(entity);
    let Some(pose) = pose else {
        cloth.remove::<AnimatedPose>();
        return;
    };
    if is_skinned {
        // The simulated mesh gives the bounds, and pins follow the joints instead of the entity.
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

/// Removes everything but the body from an entity that loses its `D`. The mesh stays.
pub(crate) fn remove_mesh_body<D: MeshDescription>(removed: On<Remove<D>>, mut commands: Commands) {
    commands
        .entity(removed.entity)
        .try_remove::<(Surface, D::Parts, MeshSource, SkinOfCloth, AnimatedPose, NoAutoAabb)>();
}
