//! Meshes of torn bodies: vertices are divided and duplicated like the particles.

use std::sync::Arc;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::NoAutoAabb;
use bevy::mesh::Indices;
use bevy::prelude::*;
use drape_solver::Topology;

use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::body::tearable::{RestoredMesh, TornMesh};
use crate::body::torn_from::TornFrom;
use crate::render::any_mesh::{AnyMesh, handle_of, insert_mesh};
use crate::render::attributes::indices;
use crate::render::cut_vertices::{DrawnTriangles, blend_attributes};
use crate::render::from_mesh::cloth_mesh::WeldedVertices;
use crate::render::rope_mesh::RopeSurface;
use crate::render::surface::Surface;
use crate::render::vertex_map::TornVertices;

/// The mesh of a body before its first tear. The body and its pieces keep it, as a snapshot may make them whole again.
#[derive(Component, Clone)]
pub(crate) struct WholeMesh(Arc<Shown>);

/// A mesh, and how it shows a body.
#[derive(Clone)]
struct Shown {
    mesh: Mesh,
    is_flat: bool,
    surface: Surface,
    welded: Option<WeldedVertices>,
}

impl Shown {
    /// The mesh that an entity has.
    fn of(entity: Entity, bodies: &ShownBodies, meshes: &Assets<Mesh>) -> Option<Self> {
        let (mesh, surface, welded) = bodies.get(entity).ok()?;
        let (is_flat, mesh) = (mesh.1.is_some(), meshes.get(handle_of(mesh)?)?.clone());
        Some(Self { mesh, is_flat, surface: surface.clone(), welded: welded.cloned() })
    }

    /// True if it shows a body as it was before its first tear.
    fn is_whole(&self, torn_from: Option<&TornFrom>) -> bool {
        let topology = &self.surface.topology;
        torn_from.is_some_and(|torn_from| Arc::ptr_eq(&torn_from.whole.topology, topology))
    }

    /// The mesh of a piece of the body, whose particles have these origins; none if a vertex or the data are missing.
    fn torn(&self, origins: &[u32], topology: &Arc<Topology>) -> Option<Self> {
        let vertices = self.surface.welded().map(|vertices| vertices.torn(origins, topology));
        let (from, drawn) = match &vertices {
            Some(TornVertices { map, origins }) => {
                let particle = |vertex: u32| map.particles[vertex as usize].unwrap_or_default();
                (&**origins, DrawnTriangles::new(topology, map.triangles(), origins.len(), particle))
            }
            None => {
                (origins, DrawnTriangles::new(topology, topology.faces(), origins.len(), |vertex| vertex))
            }
        };
        let mesh = torn_mesh(&self.mesh, from, &drawn)?;
        let welded = vertices.as_ref().map(|TornVertices { map, .. }| {
            let particles = map.particles.iter().copied();
            WeldedVertices::torn(particles.chain(drawn.cut.iter().map(|_| None)).collect())
        });
        let vertices = vertices.map(|vertices| vertices.map);
        let surface = self.surface.torn(origins, topology, vertices, drawn.cut)?;
        Some(Self { mesh, is_flat: self.is_flat, surface, welded })
    }
}

/// A mesh that an entity will get.
struct Made {
    entity: Entity,
    /// The asset that it replaces; none for a new piece.
    handle: Option<Handle<Mesh>>,
    shown: Shown,
    bounds: Aabb,
}

impl Made {
    fn put(self, commands: &mut Commands, meshes: &mut Assets<Mesh>) {
        let Self { entity, handle, shown: Shown { mesh, is_flat, mut surface, welded }, bounds } = self;
        let handle = match handle {
            Some(handle) => {
                if let Some(mut known) = meshes.get_mut(&handle) {
                    *known = mesh;
                }
                handle
            }
            None => meshes.add(mesh),
        };
        surface.mesh = handle.id();
        let mut entity = commands.entity(entity);
        if let Some(welded) = welded {
            entity.insert(welded);
        }
        entity.insert((surface, NoAutoAabb, bounds));
        insert_mesh(&mut entity, is_flat, handle);
    }
}

/// Bodies that show their particles.
type ShownBodies<'w, 's> = Query<'w, 's, (AnyMesh, &'static Surface, Option<&'static WeldedVertices>)>;

/// Gives torn bodies and their pieces new meshes.
pub(crate) fn tear_meshes(
    mut commands: Commands,
    torn: Query<(Entity, &TornMesh, &Sticks, &BodyState, &GlobalTransform, Has<WholeMesh>)>,
    bodies: ShownBodies,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    // All meshes are made before the first one is replaced, since others are made from it.
    let mut made = Vec::new();
    let mut sources: Vec<(Entity, Option<Arc<Shown>>)> = Vec::new();
    for (entity, TornMesh { source, origins }, sticks, state, transform, knows_whole) in &torn {
        commands.entity(entity).remove::<TornMesh>();
        let place = sources.iter().position(|(known, _)| known == source).unwrap_or_else(|| {
            sources.push((*source, Shown::of(*source, &bodies, &meshes).map(Arc::new)));
            sources.len() - 1
        });
        let Some(before) = &sources[place].1 else { continue };
        if origins.len() != sticks.particle_count() {
            continue;
        }
        let Some(mut shown) = before.torn(origins, &sticks.0) else { continue };
        if !knows_whole && before.is_whole(state.torn_from.as_ref()) {
            commands.entity(entity).insert(WholeMesh(Arc::clone(before)));
        }
        let bounds = shown.surface.write_now(&mut shown.mesh, transform).unwrap_or_default();
        let handle = if *source == entity { mesh_of(entity, &bodies) } else { None };
        made.push(Made { entity, handle, shown, bounds });
    }
    made.into_iter().for_each(|made| made.put(&mut commands, &mut meshes));
}

fn mesh_of(entity: Entity, bodies: &ShownBodies) -> Option<Handle<Mesh>> {
    handle_of(bodies.get(entity).ok()?.0).cloned()
}

/// Gives bodies that a snapshot has made whole, or torn otherwise, the meshes that they had.
pub(crate) fn restore_meshes(
    mut commands: Commands,
    restored: Query<(Entity, &RestoredMesh, &Particles, &Sticks, &BodyState, &GlobalTransform)>,
    wholes: Query<&WholeMesh>,
    bodies: ShownBodies,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let mut made = Vec::new();
    for (entity, &RestoredMesh { whole }, particles, sticks, state, transform) in &restored {
        commands.entity(entity).remove::<(RestoredMesh, TornMesh, WholeMesh, RopeSurface)>();
        let torn_from = state.torn_from.as_ref();
        let known = [entity, whole].iter().find_map(|&entity| wholes.get(entity).ok()).cloned();
        let still_whole = || Shown::of(whole, &bodies, &meshes).filter(|shown| shown.is_whole(torn_from));
        let Some(whole) = known.or_else(|| Some(WholeMesh(still_whole()?.into()))) else { continue };
        let shown = match torn_from {
            Some(torn_from) => whole.0.torn(&torn_from.origins, &sticks.0),
            None => Some(Shown::clone(&whole.0)),
        };
        let Some(mut shown) = shown else { continue };
        if torn_from.is_some() {
            commands.entity(entity).insert(whole);
        }
        if Arc::ptr_eq(&shown.surface.topology, &sticks.0) {
            shown.surface.restart(particles);
        }
        let bounds = shown.surface.write_now(&mut shown.mesh, transform).unwrap_or_default();
        made.push(Made { entity, handle: mesh_of(entity, &bodies), shown, bounds });
    }
    made.into_iter().for_each(|made| made.put(&mut commands, &mut meshes));
}

/// Creates a mesh with the vertices `origins` of another, in this order, those on the edges of cuts, and these triangles; none if a
/// vertex or the data are missing.
fn torn_mesh(mesh: &Mesh, origins: &[u32], drawn: &DrawnTriangles) -> Option<Mesh> {
    let count = mesh.count_vertices();
    if origins.iter().any(|&origin| origin as usize >= count) {
        return None;
    }
    let mut torn = mesh.clone();
    // `duplicate_vertices` copies vertices by index: these are the indices.
    let cut = drawn.cut.iter().map(|vertex| origins[vertex.nearest() as usize]);
    let all: Vec<u32> = origins.iter().copied().chain(cut).collect();
    let count = all.len();
    torn.try_insert_indices(Indices::U32(all)).ok()?;
    torn.try_duplicate_vertices().ok()?;
    torn.try_insert_indices(indices(count, drawn.triangles.as_flattened())).ok()?;
    blend_attributes(&drawn.cut, &mut torn);
    Some(torn)
}
