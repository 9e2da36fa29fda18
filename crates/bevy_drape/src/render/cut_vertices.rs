//! Vertices on the edges of cuts: where a blade has divided a triangle, only parts of it are drawn.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::collections::HashMap;

use bevy::math::Vec3;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use drape_solver::{FacePart, Topology};

/// A vertex between those at the corners of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CutVertex {
    vertices: [u32; 3],
    /// The weight of each, which sum to 1.
    weights: Vec3,
}

impl CutVertex {
    fn blend(&self, values: &[[f32; 3]]) -> Vec3 {
        let weighted = self.vertices.iter().zip(self.weights.to_array());
        weighted.map(|(&vertex, weight)| Vec3::from_array(values[vertex as usize]) * weight).sum()
    }

    /// The one that is nearest.
    pub fn nearest(&self) -> u32 {
        self.vertices[self.weights.max_position()]
    }
}

/// The triangles of a body that are drawn, and the vertices that they have besides those of the body.
#[derive(Default)]
pub(crate) struct DrawnTriangles {
    pub triangles: Vec<[u32; 3]>,
    pub cut: Vec<CutVertex>,
    /// Numbers of cut vertices, by the vertices with a weight and the bits of it.
    known: HashMap<Vec<(u32, u32)>, u32>,
}

impl DrawnTriangles {
    /// Those of a body with this topology that is shown by `triangles` among `count` vertices.
    pub fn new(
        topology: &Topology,
        triangles: &[[u32; 3]],
        count: usize,
        particle: impl Fn(u32) -> u32,
    ) -> Self {
        let mut parts: HashMap<[u32; 3], Vec<&FacePart>> = HashMap::new();
        for part in topology.face_parts() {
            parts.entry(sorted(topology.faces()[part.face as usize])).or_default().push(part);
        }
        let mut drawn = Self::default();
        for &triangle in triangles {
            let particles = triangle.map(&particle);
            match parts.get(&sorted(particles)) {
                Some(parts) => {
                    for part in parts {
                        drawn.add(part, topology.faces()[part.face as usize], triangle, particles, count);
                    }
                }
                None => drawn.triangles.push(triangle),
            }
        }
        drawn
    }

    fn add(
        &mut self,
        part: &FacePart,
        face: [u32; 3],
        triangle: [u32; 3],
        particles: [u32; 3],
        count: usize,
    ) {
        let places =
            face.map(|corner| particles.iter().position(|&other| other == corner).unwrap_or_default());
        let vertices = places.map(|place| triangle[place]);
        let corners: Vec<u32> =
            part.corners.iter().map(|&weights| self.number(CutVertex { vertices, weights }, count)).collect();
        // The winding of the mesh, which may not be that of the body.
        let is_turned = (places[0] + 1) % 3 != places[1];
        for corners in part.triangles().map(|of| of.map(|corner| corners[corner])) {
            let [a, b, c] = corners;
            self.triangles.push(if is_turned { [a, c, b] } else { corners });
        }
    }

    /// The number of a vertex: that of a corner of the triangle, or one behind all `count` vertices of the body.
    fn number(&mut self, vertex: CutVertex, count: usize) -> u32 {
        let weighted = vertex.vertices.into_iter().zip(vertex.weights.to_array());
        let mut key: Vec<(u32, u32)> = weighted
            .filter(|&(_, weight)| weight != 0.0)
            .map(|(of, weight)| (of, weight.to_bits()))
            .collect();
        if let [(corner, _)] = key[..] {
            return corner;
        }
        key.sort_unstable();
        *self.known.entry(key).or_insert_with(|| {
            self.cut.push(vertex);
            (count + self.cut.len() - 1) as u32
        })
    }
}

fn sorted(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

/// Writes the positions and normals of `cut` vertices, which come behind those between which they lie.
pub(crate) fn write_cut(cut: &[CutVertex], positions: &mut [[f32; 3]], normals: &mut [[f32; 3]]) {
    let count = positions.len() - cut.len();
    for (vertex, place) in cut.iter().zip(count..) {
        positions[place] = vertex.blend(&positions[..count]).to_array();
        normals[place] = vertex.blend(&normals[..count]).normalize_or(Vec3::Z).to_array();
    }
}

/// Gives the last vertices of a mesh, which are `cut`, values between those of others in each attribute of two to four `f32`s, such as
/// texture coordinates and colours. In others they keep those of the nearest vertex.
pub(crate) fn blend_attributes(cut: &[CutVertex], mesh: &mut Mesh) {
    let Ok(attributes) = mesh.try_attributes_mut() else { return };
    for (_, values) in attributes {
        match values {
            VertexAttributeValues::Float32x2(values) => blend_values(cut, values),
            VertexAttributeValues::Float32x3(values) => blend_values(cut, values),
            VertexAttributeValues::Float32x4(values) => blend_values(cut, values),
            _ => {}
        }
    }
}

fn blend_values<const N: usize>(cut: &[CutVertex], values: &mut [[f32; N]]) {
    let count = values.len() - cut.len();
    for (vertex, place) in cut.iter().zip(count..) {
        values[place] = core::array::from_fn(|axis| {
            let weighted = vertex.vertices.iter().zip(vertex.weights.to_array());
            weighted.map(|(&other, weight)| values[other as usize][axis] * weight).sum()
        });
    }
}
