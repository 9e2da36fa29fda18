//! Meshes from lists of triangles.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;

/// A mesh of these positions, in metres, and triangles.
pub(crate) fn triangle_mesh(positions: impl Into<VertexAttributeValues>, triangles: &[[u32; 3]]) -> Mesh {
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_indices(Indices::U32(triangles.as_flattened().to_vec()))
}
