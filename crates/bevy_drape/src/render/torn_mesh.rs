//! Meshes of torn bodies: vertices are divided and duplicated like the particles.

use bevy::camera::visibility::NoAutoAabb;
use bevy::mesh::Indices;
use bevy::prelude::*;

use crate::body::particles::{Particles, Sticks};
use crate::body::tearable::TornMesh;
use crate::render::attributes::indices;
use crate::render::cut_vertices::{DrawnTriangles, blend_attributes};
use crate::render::from_mesh::cloth_mesh::WeldedVertices;
use crate::render::surface::Surface;
use crate::render::vertex_map::TornVertices;

/// Gives torn bodies and their pieces new meshes.
pub(crate) fn tear_meshes(
    mut commands: Commands,
    torn: Query<(Entity, &TornMesh, &Particles, &Sticks, &GlobalTransform)>,
    whole: Query<(Option<&Mesh3d>, Option<&Mesh2d>, &Surface)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    // All meshes are made before the first one is replaced, since others are made from it.
    let mut made = Vec::new();
    for (entity, TornMesh { source, origins }, particles, sticks, transform) in &torn {
        commands.entity(entity).remove::<TornMesh>();
        let Ok((solid, flat, surface)) = whole.get(*source) else { continue };
        let Some(handle) = flat.map(|mesh| &mesh.0).or(solid.map(|mesh| &mesh.0)) else { continue };
        if origins.len() != particles.len() {
            continue;
        }
        let vertices = surface.welded().map(|vertices| vertices.torn(origins, &sticks.0));
        let (from, drawn) = match &vertices {
            Some(TornVertices { map, origins }) => {
                let particle = |vertex: u32| map.particles[vertex as usize].unwrap_or_default();
                (&**origins, DrawnTriangles::new(&sticks.0, map.triangles(), origins.len(), particle))
            }
            None => {
                (&**origins, DrawnTriangles::new(&sticks.0, sticks.faces(), origins.len(), |vertex| vertex))
            }
        };
        let mesh = meshes.get(handle).and_then(|mesh| torn_mesh(mesh, from, &drawn));
        let surface = surface.torn(origins, &sticks.0, vertices.map(|vertices| vertices.map), drawn.cut);
        let (Some(mut mesh), Some(mut own)) = (mesh, surface) else { continue };
        let bounds = own.write_now(&mut mesh, transform);
        let handle = (*source == entity).then(|| handle.clone());
        made.push((entity, flat.is_some(), handle, mesh, own, bounds.unwrap_or_default()));
    }
    for (entity, is_flat, handle, mesh, mut surface, bounds) in made {
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
        if let Some(vertices) = surface.welded() {
            let cut = surface.vertex_count() - vertices.particles.len();
            let particles = vertices.particles.iter().copied().chain(core::iter::repeat_n(None, cut));
            commands.entity(entity).insert(WeldedVertices::torn(particles.collect()));
        }
        let mut entity = commands.entity(entity);
        entity.insert((surface, NoAutoAabb, bounds));
        if is_flat {
            entity.insert(Mesh2d(handle));
        } else {
            entity.insert(Mesh3d(handle));
        }
    }
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
