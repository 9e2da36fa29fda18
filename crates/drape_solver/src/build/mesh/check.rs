//! Checks of a mesh before a body is built from it.
//!
//! Design: docs/design/cloth_from_meshes.md.

use glam::Vec3;

use crate::build::cloth::MAX_PARTICLES;
use crate::build::mesh::error::MeshError;
use crate::build::mesh::weld::weld;
use crate::constants::MAX_MAGNITUDE;
use crate::error::BuildError;

/// The least length of a mesh in metres. Smaller meshes are probably in another unit.
const LEAST_EXTENT: f32 = 1e-4;
/// Default welding distance, as a part of the mesh's length.
pub(crate) const WELD_FRACTION: f32 = 1e-5;

/// Checks that the corners of all triangles exist and have finite positions. Returns the vertices that are corners, in the
/// order of the triangles.
pub(crate) fn used_vertices(positions: &[Vec3], faces: &[[u32; 3]]) -> Result<Vec<u32>, MeshError> {
    let count = positions.len();
    if count == 0 {
        return Err(MeshError::NoVertices);
    }
    if faces.is_empty() {
        return Err(MeshError::NoFaces { vertices: count });
    }
    if count as u64 > MAX_PARTICLES {
        return Err(BuildError::TooManyParticles { found: count as u64, limit: MAX_PARTICLES }.into());
    }
    let mut used = Vec::new();
    let mut is_used = vec![false; count];
    for (face, &vertex) in faces.iter().enumerate().flat_map(|(i, face)| face.iter().map(move |v| (i, v))) {
        let Some(&position) = positions.get(vertex as usize) else {
            return Err(MeshError::NoSuchVertex { face, vertex, count });
        };
        usable(vertex, position)?;
        if !core::mem::replace(&mut is_used[vertex as usize], true) {
            used.push(vertex);
        }
    }
    Ok(used)
}

/// Checks that the position of a vertex is finite and within bounds.
pub(crate) fn usable(vertex: u32, position: Vec3) -> Result<(), MeshError> {
    // Comparisons with NaN are false.
    if position.abs().max_element() <= MAX_MAGNITUDE && position.is_finite() {
        Ok(())
    } else {
        Err(MeshError::NotFinite { vertex, position })
    }
}

/// Least and greatest corner of the box around the `used` vertices.
pub(crate) fn bounds(positions: &[Vec3], used: &[u32]) -> (Vec3, Vec3) {
    let used = || used.iter().map(|&vertex| positions[vertex as usize]);
    (used().fold(Vec3::INFINITY, Vec3::min), used().fold(Vec3::NEG_INFINITY, Vec3::max))
}

/// The longest side of the box around the `used` vertices in metres.
pub(crate) fn extent(positions: &[Vec3], used: &[u32]) -> Result<f32, MeshError> {
    let (low, high) = bounds(positions, used);
    let extent = (high - low).max_element();
    if extent < LEAST_EXTENT { Err(MeshError::TooSmall { extent, least: LEAST_EXTENT }) } else { Ok(extent) }
}

/// For each vertex the first of the `used` vertices within `distance` metres; the vertex itself if it is not used.
pub(crate) fn welded(positions: &[Vec3], used: &[u32], distance: f32) -> Vec<u32> {
    let mut welded: Vec<u32> = (0..positions.len() as u32).collect();
    for (&vertex, first) in used.iter().zip(weld(positions, used, distance)) {
        welded[vertex as usize] = first;
    }
    welded
}
