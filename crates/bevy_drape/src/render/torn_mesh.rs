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
pub(crate) struct WholeMesh(Arc<ShownMesh>);

/// A mesh, and how it shows a body.
#[derive(Clone)]
struct ShownMesh {
    mesh: Mesh,
    is_flat: bool,
    surface: Surface,
    welded: Option<WeldedVertices>,
}

/// A mesh that an entity has, and how it shows a body.
#[derive(Clone, Copy)]
struct Showing<'a> {
    mesh: &'a Mesh,
    is_flat: bool,
    surface: &'a Surface,
    welded: Option<&'a WeldedVertices>,
}

impl ShownMesh {
    fn showing(&self) -> Showing<'_> {
        let Self { mesh, is_flat, surface, welded } = self;
        Showing { mesh, is_flat: *is_flat, surface, welded: welded.as_ref() }
    }
}

impl<'a> Showing<'a> {
    fn of(entity: Entity, bodies: &'a ShownBodies, meshes: &'a Assets<Mesh>) -> Option<Self> {
        Self::new(bodies.get(entity).ok()?, meshes)
    }

    fn new((mesh, surface, welded): BodyMesh<'a>, meshes: &'a Assets<Mesh>) -> Option<Self> {
        Some(Self { mesh: meshes.get(handle_of(mesh)?)?, is_flat: mesh.1.is_some(), surface, welded })
    }

    fn cloned(self) -> ShownMesh {
        let Self { mesh, is_flat, surface, welded } = self;
        ShownMesh { mesh: mesh.clone(), is_flat, surface: surface.clone(), welded: welded.cloned() }
    }

    /// True if it shows a body with this topology.
    fn has(self, topology: &Arc<Topology>) -> bool {
        Arc::ptr_eq(&self.surface.topology, topology)
    }

    /// The mesh of a piece of the body with this past, whose particles have these origins in the mesh; none if a vertex or the data are
    /// missing.
    fn torn(self, origins: &[u32], topology: &Arc<Topology>, torn_from: &TornFrom) -> Option<ShownMesh> {
        let vertices = self.surface.welded().map(|vertices| vertices.torn(origins, topology));
        let (from, drawn) = match &vertices {
            Some(TornVertices { map, origins }) => {
                let particle = |vertex: u32| map.particles[vertex as usize].unwrap_or_default();
                (
                    &**origins,
                    DrawnTriangles::new(topology, torn_from, map.triangles(), origins.len(), particle),
                )
            }
            None => (
                origins,
                DrawnTriangles::new(topology, torn_from, topology.faces(), origins.len(), |vertex| vertex),
            ),
        };
        let mesh = torn_mesh(self.mesh, from, &drawn)?;
        let welded = vertices.as_ref().map(|TornVertices { map, .. }| {
            let particles = map.particles.iter().copied();
            WeldedVertices::torn(particles.chain(drawn.cut.iter().map(|_| None)).collect())
        });
        let vertices = vertices.map(|vertices| vertices.map);
        let surface = self.surface.torn(origins, topology, vertices, drawn.cut)?;
        Some(ShownMesh { mesh, is_flat: self.is_flat, surface, welded })
    }
}

/// A mesh that an entity will get.
struct Made {
    entity: Entity,
    /// The asset that it replaces; none for a new piece.
    handle: Option<Handle<Mesh>>,
    shown: ShownMesh,
    bounds: Aabb,
}

impl Made {
    fn put(self, commands: &mut Commands, meshes: &mut Assets<Mesh>) {
        let Self { entity, handle, shown: ShownMesh { mesh, is_flat, mut surface, welded }, bounds } = self;
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

/// The mesh of a body, its surface, and the particles of its welded vertices.
type BodyMesh<'a> = ((Option<&'a Mesh3d>, Option<&'a Mesh2d>), &'a Surface, Option<&'a WeldedVertices>);

/// Bodies that show their particles.
type ShownBodies<'w, 's> = Query<'w, 's, (AnyMesh, &'static Surface, Option<&'static WeldedVertices>)>;

/// Gives torn bodies and their pieces new meshes.
pub(crate) fn tear_meshes(
    mut commands: Commands,
    torn: Query<(Entity, &TornMesh, &Sticks, &BodyState, &GlobalTransform)>,
    bodies: ShownBodies,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    // All meshes are made before the first one is replaced, since others are made from it.
    let mut made = Vec::new();
    let mut wholes: Vec<(Entity, WholeMesh)> = Vec::new();
    for (entity, TornMesh { source, origins }, sticks, state, transform) in &torn {
        commands.entity(entity).remove::<TornMesh>();
        let Some(before) = Showing::of(*source, &bodies, &meshes) else { continue };
        if origins.len() != sticks.particle_count() {
            continue;
        }
        let Some(torn_from) = &state.torn_from else { continue };
        let Some(mut shown) = before.torn(origins, &sticks.0, torn_from) else { continue };
        if before.has(&torn_from.whole.topology) {
            let known = wholes.iter().find(|(of, _)| of == source).map(|(_, whole)| whole.clone());
            let whole = known.unwrap_or_else(|| WholeMesh(before.cloned().into()));
            wholes.push((*source, whole.clone()));
            commands.entity(entity).insert(whole);
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

/// Has an entity keep its mesh as that of the whole body, if it shows a body with this topology.
pub(crate) fn keep_whole_mesh(world: &mut World, entity: Entity, whole: &Arc<Topology>) {
    let entity_of = world.entity(entity);
    let Some(meshes) = world.get_resource::<Assets<Mesh>>() else { return };
    let Some(surface) = entity_of.get::<Surface>() else { return };
    let body = ((entity_of.get(), entity_of.get()), surface, entity_of.get());
    if let Some(showing) = Showing::new(body, meshes)
        && showing.has(whole)
    {
        let whole = WholeMesh(showing.cloned().into());
        world.entity_mut(entity).insert(whole);
    }
}

/// Gives bodies that a snapshot has made whole, or torn otherwise, the meshes that they had.
pub(crate) fn restore_meshes(
    mut commands: Commands,
    restored: Query<
        (Entity, &Particles, &Sticks, &BodyState, &GlobalTransform, Option<&WholeMesh>),
        With<RestoredMesh>,
    >,
    bodies: ShownBodies,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let mut made = Vec::new();
    for (entity, particles, sticks, state, transform, own) in &restored {
        commands.entity(entity).remove::<(RestoredMesh, TornMesh, RopeSurface)>();
        let Some(torn_from) = &state.torn_from else {
            // Without a whole mesh, its own is that still.
            commands.entity(entity).remove::<WholeMesh>();
            made.extend(
                own.map(|WholeMesh(whole)| (entity, particles, sticks, transform, ShownMesh::clone(whole))),
            );
            continue;
        };
        let still_whole =
            || Showing::of(entity, &bodies, &meshes).filter(|shown| shown.has(&torn_from.whole.topology));
        let own = own.filter(|WholeMesh(whole)| whole.showing().has(&torn_from.whole.topology));
        let whole = own.cloned().or_else(|| Some(WholeMesh(still_whole()?.cloned().into())));
        let Some(WholeMesh(whole)) = whole else { continue };
        made.extend(
            whole
                .showing()
                .torn(&torn_from.origins, &sticks.0, torn_from)
                .map(|torn| (entity, particles, sticks, transform, torn)),
        );
        commands.entity(entity).insert(WholeMesh(whole));
    }
    for (entity, particles, sticks, transform, mut shown) in made {
        if shown.showing().has(&sticks.0) {
            shown.surface.restart(particles);
        }
        let bounds = shown.surface.write_now(&mut shown.mesh, transform).unwrap_or_default();
        let handle = mesh_of(entity, &bodies);
        Made { entity, handle, shown, bounds }.put(&mut commands, &mut meshes);
    }
}

/// Creates a mesh with the vertices `origins` of another, in this order, those on the edges of cuts and tears, and these triangles; none if a
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
