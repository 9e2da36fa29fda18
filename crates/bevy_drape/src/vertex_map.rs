//! How the vertices of a mesh hang on the particles of its cloth.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::math::Vec3;

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
    /// The first vertex of the same particle with the same normal.
    first: Vec<u32>,
    /// Triangles of such vertices, turned as the normals of the mesh have it.
    faces: Vec<[u32; 3]>,
}

impl VertexMap {
    /// For a mesh with triangles `faces` of vertices at `positions`, and with normals if it has any.
    pub fn new(
        particles: Vec<Option<u32>>,
        positions: &[[f32; 3]],
        normals: Option<&[[f32; 3]]>,
        mut faces: Vec<[u32; 3]>,
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
        faces.retain(|face| face.iter().all(|&corner| particles[corner as usize].is_some()));
        for face in &mut faces {
            let [a, b, c] = face.map(|corner| Vec3::from_array(positions[corner as usize]));
            let said: Vec3 = face.iter().filter_map(|&corner| normal(corner)).sum();
            if (b - a).cross(c - a).dot(said) < 0.0 {
                face.swap(1, 2);
            }
            *face = face.map(|corner| first[corner as usize]);
        }
        Self { particles: particles.into(), first, faces }
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
