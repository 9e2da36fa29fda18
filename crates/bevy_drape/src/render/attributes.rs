//! Attributes and indices of meshes that bodies are written into.

use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::prelude::*;
use drape_solver::Topology;

use crate::render::shown::Shown;

/// Adds missing normals, texture coordinates and indices to `mesh`. False if it does not have one position for each
/// particle.
pub(crate) fn complete(mesh: &mut Mesh, shown: &impl Shown, topology: &Topology) -> bool {
    let count = topology.particle_count();
    let has = |mesh: &Mesh, id| mesh.try_attribute_option(id).ok().flatten().map(VertexAttributeValues::len);
    let positions = mesh.try_attribute_option(Mesh::ATTRIBUTE_POSITION).ok().flatten();
    let Some(VertexAttributeValues::Float32x3(positions)) = positions else {
        return false;
    };
    if positions.len() != count {
        return false;
    }
    if has(mesh, Mesh::ATTRIBUTE_NORMAL) != Some(count) {
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; count]);
    }
    if has(mesh, Mesh::ATTRIBUTE_UV_0) != Some(count) {
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, shown.texture_coordinates());
    }
    if mesh.try_indices_option().is_ok_and(|indices| indices.is_none()) {
        mesh.insert_indices(indices(count, topology.faces().as_flattened()));
    }
    true
}

/// Indices among `count` vertices, as short as they may be: they are copied whenever the vertices have changed.
pub(crate) fn indices(count: usize, corners: &[u32]) -> Indices {
    // The greatest number is left free: in a strip it would begin a new one.
    if count <= usize::from(u16::MAX) {
        Indices::U16(corners.iter().map(|&corner| corner as u16).collect())
    } else {
        Indices::U32(corners.to_vec())
    }
}

/// True if `mesh` has a position and a normal for each of `count` particles.
pub(crate) fn can_be_written(mesh: &Mesh, count: usize) -> bool {
    [Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_NORMAL].into_iter().all(|attribute| {
        let values = mesh.try_attribute_option(attribute).ok().flatten();
        matches!(values, Some(VertexAttributeValues::Float32x3(values)) if values.len() == count)
    })
}

/// Returns both buffers at once.
pub(crate) fn position_and_normal(mesh: &mut Mesh) -> Option<(&mut Vec<[f32; 3]>, &mut Vec<[f32; 3]>)> {
    let (mut positions, mut normals) = (None, None);
    for (attribute, values) in mesh.try_attributes_mut().ok()? {
        let VertexAttributeValues::Float32x3(values) = values else {
            continue;
        };
        if attribute.id == Mesh::ATTRIBUTE_POSITION.id {
            positions = Some(values);
        } else if attribute.id == Mesh::ATTRIBUTE_NORMAL.id {
            normals = Some(values);
        }
    }
    positions.zip(normals)
}
