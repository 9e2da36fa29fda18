//! Detailed meshes that follow coarse bodies.
//!
//! ```text
//!         .---o---.        vertices of the detailed mesh hang on the nearest triangle
//!     o--'    |    '--o    at rest: so much of each of its corners, so far off it
//!    *--------+--------*   particles of the body
//! ```

use std::sync::Arc;

use bevy::camera::visibility::NoAutoAabb;
use bevy::prelude::*;
use drape_solver::{Embedding, Topology};

use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::refusal::{Cause, Refusals};
use crate::render::from_mesh::reading::MeshFault;
use crate::render::from_mesh::soft_body::SolidCells;
use crate::render::from_mesh::source::{ChangedMeshes, FaultyMesh, MeshParts, MeshSource, show_copy};
use crate::render::surface::Surface;
use crate::render::vertices::{EmbeddedVertices, Vertices};
use crate::render::visibility::HiddenByCulling;

/// Lets the entity's [`Mesh3d`] follow the body of another entity: a detailed jacket on a coarse cloth, a bunny of many
/// triangles on a jelly of few cells.
///
/// Each vertex is bound to the nearest triangle of the body at rest and keeps its distance along the normal. Bent
/// triangles count as curved, so that the mesh shows no creases; at sharp folds the mesh leaves the flat triangles by
/// less than half their sides. On a [`SoftBodyMesh`](crate::render::from_mesh::soft_body::SoftBodyMesh) a vertex follows its
/// cell. The [`Transform`]s of the two entities place the mesh on the body: align it with the body at rest. Once bound,
/// vertices follow the body, wherever the entity is. Texture coordinates and indices stay as they are; a copy of the
/// mesh is shown.
///
/// It is bound after the first step with both body and mesh, and again after a change of the component, the mesh, its
/// asset or the body. After the driver is despawned the mesh stays as it is. To draw only the mesh, leave out the
/// driver's `MeshMaterial3d` rather than hide the driver, so that pointers still hit it. A driver may
/// [tear](crate::body::tearable::Tearable), but the mesh does not: it follows the rest of the driver.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::render::DrivenMesh;
/// # fn setup(mut commands: Commands, assets: Res<AssetServer>) {
/// let cells = commands.spawn((Mesh3d(assets.load("bunny.gltf#Mesh0/Primitive0")), SoftBodyMesh::new(0.1))).id();
/// commands.spawn((Mesh3d(assets.load("bunny.gltf#Mesh1/Primitive0")), DrivenMesh { driver: cells }));
/// # }
/// ```
#[derive(Component, FromTemplate, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct DrivenMesh {
    /// The entity with the body: a [`Cloth`](crate::build::cloth::Cloth),
    /// [`ClothMesh`](crate::render::from_mesh::cloth_mesh::ClothMesh),
    /// [`SoftBodyMesh`](crate::render::from_mesh::soft_body::SoftBodyMesh) or [`SoftBall`](crate::build::soft_ball::SoftBall).
    #[entities]
    pub driver: Entity,
}

/// The body that a mesh was bound to, or could not be bound to.
#[derive(Component, Clone, Debug)]
pub(crate) struct Binding {
    driver: Entity,
    topology: Arc<Topology>,
}

/// Binds meshes that were inserted or changed since the last step, or that have another driver or driver's body.
pub(crate) fn build_driven_meshes(
    mut commands: Commands,
    mut changed: ChangedMeshes<DrivenMesh>,
    bindings: Query<(Entity, &DrivenMesh, Option<&Binding>), Without<Particles>>,
    driven: Query<(&Mesh3d, &GlobalTransform, Option<&MeshSource>), Without<Particles>>,
    bodies: Query<(&Particles, &Sticks, &BodyState, &GlobalTransform, Option<&SolidCells>)>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut refusals: ResMut<Refusals>,
    mut to_bind: Local<Vec<Entity>>,
) {
    changed.collect(&mut to_bind);
    let mut later = Vec::new();
    for (entity, &DrivenMesh { driver }, binding) in &bindings {
        let Ok((particles, sticks, state, from, cells)) = bodies.get(driver) else { continue };
        let is_bound = binding
            .is_some_and(|binding| binding.driver == driver && Arc::ptr_eq(&binding.topology, &sticks.0));
        if is_bound && !to_bind.contains(&entity) || particles.len() != sticks.particle_count() {
            continue;
        }
        let Ok((mesh, transform, made)) = driven.get(entity) else { continue };
        let source = MeshSource::of(mesh, made);
        let Some(asset) = meshes.get(&source) else {
            later.push(entity);
            continue;
        };
        // From the mesh into the driver's coordinates.
        let to_driver = from.affine().inverse() * transform.affine();
        let bound = if to_driver.is_finite() {
            let embed = |points: &[Vec3]| match cells {
                Some(cells) => Ok(cells.embed(points)?),
                None if sticks.faces().is_empty() => Err(MeshFault::NoFacesToDrive(driver)),
                None => {
                    let at_rest = |&point: &Vec3| state.rest.transform_point3(point);
                    Ok(Embedding::on_faces(&points.iter().map(at_rest).collect::<Vec<_>>(), sticks)?)
                }
            };
            let local = |&place: &[f32; 3]| to_driver.transform_point3(place.into());
            let fault = |fault| ("DrivenMesh", Cause::from(FaultyMesh::new(&source, fault)));
            bind(asset, |positions| embed(&positions.iter().map(local).collect::<Vec<_>>())).map_err(fault)
        } else {
            Err(("Transform", "it and that of the driver must be finite, with a scale above zero".into()))
        };
        let mut driven = commands.entity(entity);
        match bound {
            Ok((vertices, copy)) => {
                refusals.forget(entity);
                let surface = Surface::of_mesh(particles, &sticks.0, Vertices::Embedded(vertices));
                show_copy(&mut driven, &mut meshes, transform, source, surface, copy);
            }
            Err((component, reason)) => {
                refusals.entity(entity, component, reason);
                driven.remove::<Surface>().insert(MeshSource::refused(mesh, made));
            }
        }
        driven.insert(Binding { driver, topology: Arc::clone(&sticks.0) });
    }
    to_bind.clear();
    to_bind.append(&mut later);
}

/// Binds the vertices of a mesh with `embed`, and copies the mesh to show it.
fn bind(
    mesh: &Mesh,
    embed: impl Fn(&[[f32; 3]]) -> Result<Embedding, MeshFault>,
) -> Result<(EmbeddedVertices, Mesh), MeshFault> {
    let parts = MeshParts::of(mesh)?;
    parts.check_faces()?;
    let MeshParts { positions, normals, faces } = &parts;
    let vertices = EmbeddedVertices::new(embed(positions)?, positions, *normals, faces);
    Ok((vertices, parts.copy_to_show(mesh)))
}

/// Records the drivers after a step.
pub(crate) fn record_driven_surfaces(
    mut driven: Query<(&DrivenMesh, &mut Surface), Without<Particles>>,
    bodies: Query<Ref<Particles>>,
) {
    for (driven, mut surface) in &mut driven {
        match bodies.get(driven.driver) {
            Ok(particles) if particles.is_changed() => surface.record(&particles),
            _ => surface.settle(),
        }
    }
}

/// Hides meshes with culled drivers, and shows them again when the drivers return.
pub(crate) fn hide_driven(
    mut commands: Commands,
    mut driven: Query<(Entity, &DrivenMesh, &mut Visibility, Option<&HiddenByCulling>), Without<Activity>>,
    bodies: Query<&Activity>,
) {
    for (entity, driven, mut visibility, hidden) in &mut driven {
        let is_culled = bodies.get(driven.driver).is_ok_and(|activity| *activity == Activity::Culled);
        if let Some(hidden) = hidden {
            if !is_culled {
                hidden.show(&mut visibility);
                commands.entity(entity).remove::<HiddenByCulling>();
            }
        } else if is_culled {
            commands.entity(entity).insert(HiddenByCulling::hide(&mut visibility));
        }
    }
}

/// Removes everything that an entity got for its lost [`DrivenMesh`]. The mesh stays.
pub(crate) fn remove_driven_mesh(removed: On<Remove<DrivenMesh>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<(Surface, Binding, MeshSource, NoAutoAabb)>();
}
