//! Vertices on the edges of cuts and tears: where a blade has divided a triangle, only parts of it are drawn, and torn edges are rough.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::collections::{BTreeMap, HashMap};

use bevy::math::Vec3;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use drape_solver::{FacePart, FacePoint, FrayedEdges, Topology};

use crate::body::torn_from::TornFrom;
use crate::render::entity_space::EntitySpace;

/// A vertex in the plane of those at the corners of a triangle.
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

    /// True if it lies outside the triangle.
    fn is_outside(&self) -> bool {
        self.weights.min_element() < 0.0
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
    /// Those of a torn body with this topology that is shown by `triangles` among `count` vertices.
    pub fn new(
        topology: &Topology,
        torn_from: &TornFrom,
        triangles: &[[u32; 3]],
        count: usize,
        particle: impl Fn(u32) -> u32,
    ) -> Self {
        let frayed = FrayedVertices::new(topology, torn_from, triangles, &particle);
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
                None if frayed.is_near(particles) => drawn.add_frayed(triangle, particles, &frayed, count),
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

    /// Adds a triangle that no blade has divided, near a torn edge.
    fn add_frayed(&mut self, triangle: [u32; 3], particles: [u32; 3], frayed: &FrayedVertices, count: usize) {
        let mut corners = triangle;
        for corner in &mut corners {
            if let Some(&vertex) = frayed.vertices.get(corner) {
                *corner = self.number(vertex, count);
            }
        }
        let edges = [[0, 1], [1, 2], [2, 0]].map(|[from, to]| {
            let [p, q] = [particles[from], particles[to]];
            let vertex = *frayed.edges.get(&[p.min(q), p.max(q)])?;
            Some(self.number(vertex, count))
        });
        let outline: Vec<u32> = corners
            .into_iter()
            .zip(edges)
            .flat_map(|(corner, edge)| [Some(corner), edge])
            .flatten()
            .collect();
        // From the first vertex on an edge, so that none of the triangles is flat.
        let start = edges.iter().position(Option::is_some).map_or(0, |edge| edge + 1);
        let at = |place: usize| outline[(start + place) % outline.len()];
        self.triangles.extend((2..outline.len()).map(|last| [at(0), at(last - 1), at(last)]));
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

/// The vertices of the frayed edges of a body.
#[derive(Default)]
struct FrayedVertices {
    /// By the vertices whose places they take.
    vertices: BTreeMap<u32, CutVertex>,
    /// By the particles of the edge on which they lie, the lower index first.
    edges: BTreeMap<[u32; 2], CutVertex>,
    /// True for the particles of the faces that have such vertices; empty if there are none.
    is_near: Vec<bool>,
}

impl FrayedVertices {
    fn new(
        topology: &Topology,
        torn_from: &TornFrom,
        triangles: &[[u32; 3]],
        particle: &impl Fn(u32) -> u32,
    ) -> Self {
        if torn_from.torn_edges.is_empty() {
            return Self::default();
        }
        // The vertex that shows each particle, unless there are several.
        let mut shown = vec![None; topology.particle_count()];
        for &vertex in triangles.as_flattened() {
            let known = shown[particle(vertex) as usize].get_or_insert(Some(vertex));
            *known = known.filter(|&known| known == vertex);
        }
        let one = |of: u32| shown[of as usize].flatten();
        let frayed = FrayedEdges::new(topology, &torn_from.past(), |particle| one(particle).is_some());
        let points = frayed.particles.values().chain(frayed.edges.values());
        let faces = points.map(|point| sorted(topology.faces()[point.face as usize]));
        let mut triangle_of: BTreeMap<[u32; 3], Option<[u32; 3]>> = faces.map(|face| (face, None)).collect();
        let mut is_near = vec![false; topology.particle_count()];
        triangle_of.keys().flatten().for_each(|&particle| is_near[particle as usize] = true);
        for &triangle in triangles {
            let particles = triangle.map(particle);
            if particles.iter().all(|&particle| is_near[particle as usize])
                && let Some(known) = triangle_of.get_mut(&sorted(particles))
            {
                *known = Some(triangle);
            }
        }
        let vertex = |&FacePoint { face, weights }: &FacePoint| {
            let face = topology.faces()[face as usize];
            let triangle = (*triangle_of.get(&sorted(face))?)?;
            let of = |corner: u32| triangle.into_iter().find(|&vertex| particle(vertex) == corner);
            let [a, b, c] = face.map(of);
            Some(CutVertex { vertices: [a?, b?, c?], weights })
        };
        Self {
            vertices: frayed
                .particles
                .iter()
                .filter_map(|(&particle, point)| Some((one(particle)?, vertex(point)?)))
                .collect(),
            edges: frayed.edges.iter().filter_map(|(&edge, point)| Some((edge, vertex(point)?))).collect(),
            is_near,
        }
    }

    /// True if a triangle of these particles may have such vertices.
    fn is_near(&self, particles: [u32; 3]) -> bool {
        particles.iter().any(|&particle| self.is_near.get(particle as usize) == Some(&true))
    }
}

fn sorted(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

/// Writes the positions and normals of `cut` vertices, which come behind those whose weights they have, and returns the
/// greatest distance in metres of one that lies outside its triangle from the nearest corner.
pub(crate) fn write_cut(
    cut: &[CutVertex],
    space: &EntitySpace,
    positions: &mut [[f32; 3]],
    normals: &mut [[f32; 3]],
) -> f32 {
    let count = positions.len() - cut.len();
    let mut greatest = 0.0_f32;
    for (vertex, place) in cut.iter().zip(count..) {
        let at = vertex.blend(&positions[..count]);
        if vertex.is_outside() {
            let offset = at - Vec3::from_array(positions[vertex.nearest() as usize]);
            greatest = greatest.max(space.to_world.transform_vector3(offset).length());
        }
        positions[place] = at.to_array();
        normals[place] = vertex.blend(&normals[..count]).normalize_or(Vec3::Z).to_array();
    }
    greatest
}

/// Gives the last vertices of a mesh, which are `cut`, values between those of others in each attribute of two to four `f32`s, such as
/// texture coordinates and colours. In others they keep those of the nearest vertex.
pub(crate) fn blend_attributes(cut: &[CutVertex], mesh: &mut Mesh) {
    let Ok(attributes) = mesh.try_attributes_mut() else { return };
    for (attribute, values) in attributes {
        // A texture goes on beyond the edge of a face, colours and the like end there.
        let is_texture = [Mesh::ATTRIBUTE_UV_0.id, Mesh::ATTRIBUTE_UV_1.id].contains(&attribute.id);
        let weights = |vertex: &CutVertex| {
            let inside = vertex.weights.max(Vec3::ZERO);
            if is_texture { vertex.weights } else { inside / inside.element_sum() }
        };
        match values {
            VertexAttributeValues::Float32x2(values) => blend_values(cut, weights, values),
            VertexAttributeValues::Float32x3(values) => blend_values(cut, weights, values),
            VertexAttributeValues::Float32x4(values) => blend_values(cut, weights, values),
            _ => {}
        }
    }
}

fn blend_values<const N: usize>(
    cut: &[CutVertex],
    weights: impl Fn(&CutVertex) -> Vec3,
    values: &mut [[f32; N]],
) {
    let count = values.len() - cut.len();
    for (vertex, place) in cut.iter().zip(count..) {
        values[place] = core::array::from_fn(|axis| {
            let weighted = vertex.vertices.iter().zip(weights(vertex).to_array());
            weighted.map(|(&other, weight)| values[other as usize][axis] * weight).sum()
        });
    }
}
