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
use drape_solver::{Embedding, MeshError, Topology};

use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::refusal::Refusals;
use crate::render::from_mesh::reading::MeshFault;
use crate::render::from_mesh::soft_body::SolidCells;
use crate::render::from_mesh::source::{ChangedMeshes, MeshParts, MeshSource, called, show_copy};
use crate::render::surface::Surface;
use crate::render::vertices::{EmbeddedVertices, Vertices};
use crate::render::visibility::HiddenByCulling;

/// Has the entity's [`Mesh3d`] follow the body of another entity: a detailed jacket that goes with a coarse cloth, a bunny of
/// many triangles on a jelly of few cells.
///
/// Each vertex hangs on the nearest triangle of the body at rest, and stays as far off as it was, along the normal; where the body is bent, its
/// triangles count as round, so that the mesh shows no creases. Where that is folded sharply it so leaves the flat triangles, by less
/// than half of their sides. On a
/// [`SoftBody`](crate::render::from_mesh::soft_body::SoftBody) it goes with the cell that it is in. Where the mesh lies on the body is told by the
/// [`Transform`]s of the two entities: place it as it fits the body as that was made. Once it is bound, vertices are
/// written to where the body has them, wherever the entity is. Texture coordinates and indices stay the mesh's own, and so does the mesh: a
/// copy is shown.
///
/// It is bound after the first step in which there are body and mesh, and anew when the component, the mesh, its asset or the body
/// is changed. When the driver is gone the mesh stays as it is. The driver need not be shown: leave out its
/// `MeshMaterial3d` rather than hide it, so that pointers still meet it. Where the driver [tears](crate::body::tearable::Tearable), the mesh
/// does not: it goes on with what is left of the driver.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands, assets: Res<AssetServer>) {
/// let cells = commands.spawn((Mesh3d(assets.load("bunny.gltf#Mesh0/Primitive0")), SoftBody::new(0.1))).id();
/// commands.spawn((Mesh3d(assets.load("bunny.gltf#Mesh1/Primitive0")), DrivenMesh { driver: cells }));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct DrivenMesh {
    /// The entity with the body: a [`Cloth`](crate::build::cloth::Cloth), a [`ClothMesh`](crate::render::from_mesh::cloth_mesh::ClothMesh), a
    /// [`SoftBody`](crate::render::from_mesh::soft_body::SoftBody), a [`SoftBall`](crate::build::soft_ball::SoftBall).
    #[entities]
    pub driver: Entity,
}

/// What a mesh was bound to, or could not be.
#[derive(Component, Clone, Debug)]
pub(crate) struct Binding {
    driver: Entity,
    topology: Arc<Topology>,
}

/// Binds what was inserted or changed since the last step, and what has got another driver.
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
        // Into the driver's own coordinates.
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
            let fault = |fault| ("DrivenMesh", format!("{}: {fault}", called(&source)));
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

/// How the vertices of a mesh follow what `embed` binds them to, and the copy that shows it.
fn bind(
    mesh: &Mesh,
    embed: impl Fn(&[[f32; 3]]) -> Result<Embedding, MeshFault>,
) -> Result<(EmbeddedVertices, Mesh), MeshFault> {
    let parts = MeshParts::of(mesh)?;
    let MeshParts { positions, normals, faces } = &parts;
    let count = positions.len();
    for (face, &vertex) in faces.iter().enumerate().flat_map(|(i, face)| face.iter().map(move |v| (i, v))) {
        if vertex as usize >= count {
            return Err(MeshError::NoSuchVertex { face, vertex, count }.into());
        }
    }
    let vertices = EmbeddedVertices::new(embed(positions)?, positions, *normals, faces);
    Ok((vertices, parts.copy_to_show(mesh)))
}

/// Notes where the step left the drivers.
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

/// Hides what goes with a culled body, and shows it again when that comes back.
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

/// Takes off an entity that loses its [`DrivenMesh`] what was put there. The mesh stays as it is.
pub(crate) fn remove_driven_mesh(removed: On<Remove, DrivenMesh>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<(Surface, Binding, MeshSource, NoAutoAabb)>();
}
