//! How the vertices of a mesh hang on the particles of its cloth.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::math::Vec3;
use drape_solver::Topology;

use crate::normals::write_smooth_normals;

/// Normals that differ by less than this, in radians, are one: the mesh is smooth there.
const CREASE: f32 = 1e-2;

/// How the vertices of a mesh hang on particles.
///
/// Several vertices may be one particle. Where their normals were the same they stay so, and where they were not, as along the edge of a
/// box, they stay apart: each is smooth over its own triangles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VertexMap {
    /// The particle of each vertex; one that has none stays where it is.
    pub particles: Arc<[Option<u32>]>,
    /// The triangles of the mesh whose corners have particles.
    triangles: Vec<[u32; 3]>,
    /// The first vertex of the same particle with the same normal.
    first: Vec<u32>,
    /// The triangles again, of such vertices, turned as the normals of the mesh have it.
    faces: Vec<[u32; 3]>,
}

/// What is left of a mesh's vertices in a piece of what it was.
pub(crate) struct TornVertices {
    pub map: VertexMap,
    /// For each vertex the one that it was.
    pub origins: Vec<u32>,
}

impl VertexMap {
    /// For a mesh with triangles `faces` of vertices at `positions`, and with normals if it has any.
    pub fn new(
        particles: Vec<Option<u32>>,
        positions: &[[f32; 3]],
        normals: Option<&[[f32; 3]]>,
        mut triangles: Vec<[u32; 3]>,
    ) -> Self {
        let normal = |vertex: u32| normals.and_then(|n| n.get(vertex as usize)).map(|&n| Vec3::from_array(n));
        let is_smooth = |a: u32, b: u32| match (normal(a), normal(b)) {
            (Some(a), Some(b)) => a.angle_between(b) < CREASE,
            _ => true,
        };
        let mut firsts: HashMap<u32, Vec<u32>> = HashMap::new();
        let first = (0..).zip(&particles).map(|(vertex, &particle)| {
            let Some(particle) = particle else { return vertex };
            let known = firsts.entry(particle).or_default();
            known.iter().copied().find(|&other| is_smooth(other, vertex)).unwrap_or_else(|| {
                known.push(vertex);
                vertex
            })
        });
        let first: Vec<u32> = first.collect();
        triangles.retain(|triangle| triangle.iter().all(|&corner| particles[corner as usize].is_some()));
        let face = |&triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| Vec3::from_array(positions[corner as usize]));
            let said: Vec3 = triangle.iter().filter_map(|&corner| normal(corner)).sum();
            let [p, q, r] = triangle.map(|corner| first[corner as usize]);
            if (b - a).cross(c - a).dot(said) < 0.0 { [p, r, q] } else { [p, q, r] }
        };
        let faces = triangles.iter().map(face).collect();
        Self { particles: particles.into(), triangles, first, faces }
    }

    /// The vertices of a piece, whose particles were `origins` and whose faces those of `topology` are. A vertex whose
    /// particle was split is there once for each part.
    pub fn torn(&self, origins: &[u32], topology: &Topology) -> TornVertices {
        // The faces that are left, by the particles that their corners were: the same, sorted, and what they are now.
        let was = |corner: u32| (origins[corner as usize], corner);
        let left: HashMap<[u32; 3], [u32; 3]> = topology
            .faces()
            .iter()
            .map(|face| {
                let mut corners = face.map(was);
                corners.sort_unstable();
                (corners.map(|(was, _)| was), corners.map(|(_, is)| is))
            })
            .collect();
        let (mut vertices, mut firsts) = (Numbers::default(), Numbers::default());
        let (mut triangles, mut faces) = (Vec::new(), Vec::new());
        for (triangle, face) in self.triangles.iter().zip(&self.faces) {
            let Some(mut was) = self.corners(triangle) else { continue };
            was.sort_unstable();
            let Some(is) = left.get(&was) else { continue };
            let now = |vertex: u32| {
                let particle = self.particles[vertex as usize];
                let place = was.iter().position(|&was| Some(was) == particle).unwrap_or_default();
                (vertex, is[place])
            };
            triangles.push(triangle.map(|vertex| vertices.number(now(vertex))));
            faces.push(face.map(now));
        }
        // The first vertex of a group may be one that is not left, so that the first of what is left takes its place.
        let first: Vec<u32> = vertices
            .known
            .iter()
            .map(|&(vertex, particle)| firsts.number((self.first[vertex as usize], particle)))
            .collect();
        let mut leaders = vec![u32::MAX; firsts.known.len()];
        for (vertex, &group) in (0..).zip(&first) {
            let leader = &mut leaders[group as usize];
            *leader = vertex.min(*leader);
        }
        let leader = |group: u32| leaders[group as usize];
        let faces = faces.into_iter().map(|face| face.map(|corner| leader(firsts.number(corner)))).collect();
        let map = Self {
            particles: vertices.known.iter().map(|&(_, particle)| Some(particle)).collect(),
            triangles,
            first: first.into_iter().map(leader).collect(),
            faces,
        };
        TornVertices { map, origins: vertices.known.iter().map(|&(vertex, _)| vertex).collect() }
    }

    fn corners(&self, triangle: &[u32; 3]) -> Option<[u32; 3]> {
        let [a, b, c] = triangle.map(|vertex| self.particles[vertex as usize]);
        Some([a?, b?, c?])
    }

    /// The triangles of the mesh.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The number of vertices.
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Writes the normals of vertices at `positions`.
    pub fn write_normals(&self, positions: &[[f32; 3]], normals: &mut [[f32; 3]]) {
        write_smooth_normals(positions, &self.faces, 1.0, normals);
        for (vertex, &first) in self.first.iter().enumerate() {
            normals[vertex] = normals[first as usize];
        }
    }
}

/// Numbers for pairs, in the order in which they are asked for.
#[derive(Default)]
struct Numbers {
    known: Vec<(u32, u32)>,
    numbers: HashMap<(u32, u32), u32>,
}

impl Numbers {
    fn number(&mut self, pair: (u32, u32)) -> u32 {
        *self.numbers.entry(pair).or_insert_with(|| {
            self.known.push(pair);
            self.known.len() as u32 - 1
        })
    }
}
