//! Smoothing groups: vertices of a mesh that share a normal.

use std::collections::HashMap;

use bevy::math::Vec3;

use crate::render::normals::write_smooth_normals;

/// Normals that differ by less than this angle in radians count as equal.
const CREASE: f32 = 1e-2;

/// Vertices of a mesh that share normals.
///
/// Vertices in one place with equal normals keep equal normals. Those with different ones, as along the edge of a box,
/// stay apart: each is smooth over its own triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SmoothingGroups {
    /// For each vertex, the first vertex in the same place with the same normal.
    pub first: Vec<u32>,
    /// Triangles of such vertices, oriented by the normals of the mesh.
    pub faces: Vec<[u32; 3]>,
}

impl SmoothingGroups {
    /// Groups the vertices of a mesh with these `triangles`. Vertices in one place have the same number in `points`;
    /// those without a number have their own normals.
    pub fn new(
        points: impl Iterator<Item = Option<u32>>,
        positions: &[[f32; 3]],
        normals: Option<&[[f32; 3]]>,
        triangles: &[[u32; 3]],
    ) -> Self {
        let normal = |vertex: u32| normals.and_then(|n| n.get(vertex as usize)).map(|&n| Vec3::from_array(n));
        let is_smooth = |a: u32, b: u32| match (normal(a), normal(b)) {
            (Some(a), Some(b)) => a.angle_between(b) < CREASE,
            _ => true,
        };
        let mut firsts: HashMap<u32, Vec<u32>> = HashMap::new();
        let first = (0..).zip(points).map(|(vertex, point)| {
            let Some(point) = point else { return vertex };
            let known = firsts.entry(point).or_default();
            known.iter().copied().find(|&other| is_smooth(other, vertex)).unwrap_or_else(|| {
                known.push(vertex);
                vertex
            })
        });
        let first: Vec<u32> = first.collect();
        let face = |&triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| Vec3::from_array(positions[corner as usize]));
            let said: Vec3 = triangle.iter().filter_map(|&corner| normal(corner)).sum();
            let [p, q, r] = triangle.map(|corner| first[corner as usize]);
            if (b - a).cross(c - a).dot(said) < 0.0 { [p, r, q] } else { [p, q, r] }
        };
        let faces = triangles.iter().map(face).collect();
        Self { first, faces }
    }

    /// Writes the normals of vertices at `positions`.
    pub fn write_normals(&self, positions: &[[f32; 3]], normals: &mut [[f32; 3]]) {
        write_smooth_normals(positions, &self.faces, 1.0, normals);
        for (vertex, &first) in self.first.iter().enumerate() {
            normals[vertex] = normals[first as usize];
        }
    }
}
