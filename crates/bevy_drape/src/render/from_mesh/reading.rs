//! Reads meshes: positions, triangles, texture coordinates, skins.

use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use drape_solver::{BuildError, MeshError};
use thiserror::Error;

/// Reason why no body can be made from a mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshFault {
    /// The data are only in the renderer.
    #[error("its data are with the renderer: load it with `RenderAssetUsages::MAIN_WORLD` too")]
    NotInMainWorld,
    /// The mesh has no positions.
    #[error("it has no positions, each of three numbers")]
    NoPositions,
    /// The mesh consists of points or lines.
    #[error("it is a {0:?}: a cloth needs triangles")]
    NoTriangles(PrimitiveTopology),
    /// The number of indices of a triangle list is not a multiple of three.
    #[error("its {0} indices are no whole number of triangles")]
    BrokenTriangle(usize),
    /// A named attribute is missing.
    #[error("it has no attribute “{0}”")]
    NoAttribute(String),
    /// A vertex does not have four joints and four finite weights.
    #[error("its joints and weights are not four of each, all finite, for each vertex")]
    BrokenSkin,
    /// A vertex refers to a missing joint.
    #[error("a vertex goes with joint {joint}, but its skin has {count}")]
    NoSuchJoint {
        /// The joint.
        joint: usize,
        /// The number of joints with an inverse bind pose.
        count: usize,
    },
    /// No vertex follows a joint.
    #[error("its vertices have no joints and weights")]
    NoSkin,
    /// No joint that may get a capsule moves enough of the skin.
    #[error("no joint gets a capsule: look at the names in `only` and `except`, and at `least_share`")]
    NoColliders,
    /// `ClothPaint::full_distance` is out of range.
    #[error("full_distance of its paint must be finite and 0 or more, but is {0}")]
    BadFullDistance(f32),
    /// A number of the paint is out of range.
    #[error("of its paint, {0}")]
    BadPaint(BuildError),
    /// A painted attribute does not have numbers, or not one for each vertex.
    #[error("its attribute “{0}” is not a number, or some numbers, for each vertex")]
    NoNumbers(String),
    /// A soft solid cannot have a skin.
    #[error("it goes with the joints of a skin, which a solid cannot: take off its `SkinnedMesh`")]
    SkinnedSolid,
    /// The driver of a mesh has no triangles.
    #[error("its driver {0} has no triangles to hang it on")]
    NoFacesToDrive(Entity),
    /// The triangles do not form a cloth or solid, or a field of the component is out of range.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Returns the positions of the vertices in the mesh's coordinates.
pub(crate) fn positions(mesh: &Mesh) -> Result<&[[f32; 3]], MeshFault> {
    let values =
        mesh.try_attribute_option(Mesh::ATTRIBUTE_POSITION).map_err(|_| MeshFault::NotInMainWorld)?;
    values.and_then(VertexAttributeValues::as_float3).ok_or(MeshFault::NoPositions)
}

/// Returns the first texture coordinates of the vertices.
pub(crate) fn texture_coordinates(mesh: &Mesh) -> Result<Vec<Vec2>, MeshFault> {
    let values = mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_0).map_err(|_| MeshFault::NotInMainWorld)?;
    match values {
        Some(VertexAttributeValues::Float32x2(values)) => Ok(values.iter().map(|&uv| uv.into()).collect()),
        Some(_) => Err(MeshFault::NoNumbers(Mesh::ATTRIBUTE_UV_0.name.into())),
        None => Err(MeshFault::NoAttribute(Mesh::ATTRIBUTE_UV_0.name.into())),
    }
}

/// Returns the triangles of a list or strip, with or without indices.
pub(crate) fn faces(mesh: &Mesh, vertices: usize) -> Result<Vec<[u32; 3]>, MeshFault> {
    let indices: Vec<u32> = match mesh.try_indices_option().map_err(|_| MeshFault::NotInMainWorld)? {
        Some(Indices::U16(indices)) => indices.iter().copied().map(u32::from).collect(),
        Some(Indices::U32(indices)) => indices.clone(),
        None => (0..vertices as u32).collect(),
    };
    match mesh.primitive_topology() {
        PrimitiveTopology::TriangleList => match indices.as_chunks() {
            (faces, []) => Ok(faces.to_vec()),
            _ => Err(MeshFault::BrokenTriangle(indices.len())),
        },
        PrimitiveTopology::TriangleStrip => {
            let faces = indices.array_windows().enumerate();
            Ok(faces.map(|(i, &[a, b, c])| if i % 2 == 0 { [a, b, c] } else { [b, a, c] }).collect())
        }
        other => Err(MeshFault::NoTriangles(other)),
    }
}

/// The joints that a vertex follows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VertexSkin {
    pub joints: [u16; 4],
    /// Weights of the joints; their sum is one.
    pub weights: [f32; 4],
}

impl Default for VertexSkin {
    fn default() -> Self {
        Self { joints: [0; 4], weights: [1.0, 0.0, 0.0, 0.0] }
    }
}

impl VertexSkin {
    /// Joints with weights above zero.
    pub fn used(&self) -> impl Iterator<Item = (u16, f32)> + '_ {
        self.joints.iter().copied().zip(self.weights).filter(|&(_, weight)| weight > 0.0)
    }
}

/// Returns the skin of the vertices; none without joints and weights.
pub(crate) fn skin(mesh: &Mesh) -> Result<Option<Vec<VertexSkin>>, MeshFault> {
    let attribute = |id| mesh.try_attribute_option(id).map_err(|_| MeshFault::NotInMainWorld);
    let joints = attribute(Mesh::ATTRIBUTE_JOINT_INDEX)?;
    let weights = attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT)?;
    let (Some(joints), Some(weights)) = (joints, weights) else { return Ok(None) };
    let (VertexAttributeValues::Uint16x4(joints), VertexAttributeValues::Float32x4(weights)) =
        (joints, weights)
    else {
        return Err(MeshFault::BrokenSkin);
    };
    if joints.len() != weights.len() || joints.len() != positions(mesh)?.len() {
        return Err(MeshFault::BrokenSkin);
    }
    let vertex = |(&joints, &weights): (&[u16; 4], &[f32; 4])| {
        let sum = weights.iter().sum::<f32>();
        let is_good = sum.is_finite() && weights.iter().all(|&weight| weight >= 0.0);
        match sum {
            _ if !is_good => Err(MeshFault::BrokenSkin),
            0.0 => Ok(VertexSkin { joints, ..VertexSkin::default() }),
            _ => Ok(VertexSkin { joints, weights: weights.map(|weight| weight / sum) }),
        }
    };
    joints.iter().zip(weights).map(vertex).collect::<Result<_, _>>().map(Some)
}
