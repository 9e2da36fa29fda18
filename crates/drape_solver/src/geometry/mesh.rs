//! Triangle meshes, height fields and voxels as obstacles.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;
use parry3d::query::{PointQueryWithLocation, Ray, RayCast};
use parry3d::shape::{ConvexPolyhedron, HeightField, TriMesh, TriMeshFlags, Voxels};

use crate::constants::SURFACE_NOISE;
use crate::error::BuildError;
use crate::geometry::shape::Surface;

/// A surface of triangles. Made by [`Shape::from_parry`](crate::Shape::from_parry).
#[derive(Clone)]
pub struct MeshShape {
    mesh: TriMesh,
    sides: Sides,
}

/// The side of the triangles on which the body is solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sides {
    /// The mesh is closed: its inside is solid.
    Solid,
    /// The same, and the body is convex.
    Hull,
    /// The mesh is open: a thin sheet, with air on both sides.
    Both,
    /// A height field: solid below, within its bounds.
    Top,
}

impl MeshShape {
    /// The inside of a closed mesh is solid, however its triangles are wound; an open one is a thin sheet.
    ///
    /// Vertices at one place are joined; triangles without an area are left out.
    pub(crate) fn of_mesh(mesh: &TriMesh) -> Result<Self, BuildError> {
        let sides = |mesh: &TriMesh| if is_closed(mesh.indices()) { Sides::Solid } else { Sides::Both };
        let mut shape = Self::new(mesh.vertices().to_vec(), mesh.indices().to_vec(), sides)?;
        if shape.sides == Sides::Solid && volume(&shape.mesh) < 0.0 {
            shape.mesh.reverse();
        }
        Ok(shape)
    }

    pub(crate) fn of_height_field(field: &HeightField) -> Result<Self, BuildError> {
        let (vertices, indices) = field.to_trimesh();
        Self::new(vertices, indices, |_| Sides::Top)
    }

    pub(crate) fn of_hull(hull: &ConvexPolyhedron) -> Result<Self, BuildError> {
        let (vertices, indices) = hull.to_trimesh();
        Self::new(vertices, indices, |_| Sides::Hull)
    }

    /// True if it is known to be convex.
    pub(crate) fn is_convex(&self) -> bool {
        self.sides == Sides::Hull
    }

    /// True if it has an inside: it is closed, or a height field.
    pub(crate) fn is_solid(&self) -> bool {
        self.sides != Sides::Both
    }

    /// True for a height field.
    pub(crate) fn is_bottomless(&self) -> bool {
        self.sides == Sides::Top
    }

    pub(crate) fn of_voxels(voxels: &Voxels) -> Result<Self, BuildError> {
        let (vertices, indices) = voxels.to_trimesh();
        Self::new(vertices, indices, |_| Sides::Solid)
    }

    fn new(
        vertices: Vec<Vec3>,
        mut indices: Vec<[u32; 3]>,
        sides: impl FnOnce(&TriMesh) -> Sides,
    ) -> Result<Self, BuildError> {
        if !vertices.iter().all(|vertex| vertex.is_finite()) {
            return Err(BuildError::BadShape { reason: "a vertex is not finite" });
        }
        indices.retain(|triangle| {
            let [a, b, c] = triangle.map(|i| vertices.get(i as usize).copied().unwrap_or(Vec3::ZERO));
            let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
            (b - a).cross(c - a).length() > LEAST_SINE * longest
        });
        if indices.is_empty() {
            return Err(BuildError::BadShape { reason: "it has no triangle with an area" });
        }
        let flags = TriMeshFlags::ORIENTED
            | TriMeshFlags::MERGE_DUPLICATE_VERTICES
            | TriMeshFlags::DELETE_DEGENERATE_TRIANGLES
            | TriMeshFlags::DELETE_DUPLICATE_TRIANGLES;
        let mesh = TriMesh::with_flags(vertices, indices, flags)
            .map_err(|_| BuildError::BadShape { reason: "its triangles do not form a surface" })?;
        let sides = sides(&mesh);
        Ok(Self { mesh, sides })
    }

    pub(crate) fn scaled(&self, scale: Vec3) -> Self {
        Self { mesh: self.mesh.clone().scaled(scale), sides: self.sides }
    }

    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        let bounds = self.mesh.local_aabb();
        (bounds.mins, bounds.maxs)
    }

    pub(crate) fn triangles(&self) -> &TriMesh {
        &self.mesh
    }

    pub(crate) fn surface(&self, point: Vec3) -> Surface {
        // Parry finds no triangle near a point whose distances cannot be squared, and panics.
        if !point.length_squared().is_finite() {
            return Surface { distance: f32::INFINITY, normal: Vec3::Y };
        }
        let (projection, (triangle, _)) = self.mesh.project_local_point_and_get_location(point, false);
        let face = self.mesh.triangle(triangle).normal().unwrap_or(Vec3::Y);
        let away = point - projection.point;
        let is_inside = match self.sides {
            Sides::Solid | Sides::Hull => projection.is_inside,
            Sides::Both => false,
            Sides::Top => {
                let (low, high) = self.bounds();
                let is_over = point.cmpge(low) & point.cmple(high);
                is_over.test(0) && is_over.test(2) && away.dot(face) < 0.0
            }
        };
        let length = away.length();
        let sign = if is_inside { -1.0 } else { 1.0 };
        let normal = if length > SURFACE_NOISE * point.length() { away * (sign / length) } else { face };
        Surface { distance: sign * length, normal }
    }

    /// First hit on a triangle on the `path` from `start`: the fraction of the path, and the normal towards its start.
    pub(crate) fn cast(&self, start: Vec3, path: Vec3) -> Option<(f32, Vec3)> {
        let hit = self.mesh.cast_local_ray_and_get_normal(&Ray::new(start, path), 1.0, false)?;
        let normal = if hit.normal.dot(path) > 0.0 { -hit.normal } else { hit.normal };
        Some((hit.time_of_impact, normal))
    }
}

/// Triangles whose least angle has about this sine, or less, have no reliable normal.
const LEAST_SINE: f32 = 1e-5;

/// True if every edge has a triangle on either side.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]);
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(edges).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).all(|same| same.len() % 2 == 0)
}

/// Six times the volume inside, below zero if the triangles face inwards.
fn volume(mesh: &TriMesh) -> f32 {
    mesh.triangles().map(|triangle| triangle.a.dot(triangle.b.cross(triangle.c))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d::shape::Cuboid;

    fn cube() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        Cuboid::new(Vec3::ONE).to_trimesh()
    }

    fn mesh(vertices: Vec<Vec3>, indices: Vec<[u32; 3]>) -> MeshShape {
        MeshShape::of_mesh(&TriMesh::new(vertices, indices).expect("triangles")).expect("a surface")
    }

    /// Meshes come with a vertex for each corner of each face, and wound either way.
    #[test]
    fn a_closed_mesh_is_solid_however_it_is_written_down() {
        let (vertices, indices) = cube();
        let turned = indices.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let apart: Vec<Vec3> = indices.iter().flatten().map(|&i| vertices[i as usize]).collect();
        let in_turn = (0..indices.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        for mesh in [mesh(vertices.clone(), indices), mesh(vertices, turned), mesh(apart, in_turn)] {
            let inside = mesh.surface(Vec3::new(0.9, 0.1, 0.2));
            assert!((inside.distance + 0.1).abs() < 1e-5 && inside.normal.dot(Vec3::X) > 0.999);
            let outside = mesh.surface(Vec3::new(1.5, 0.1, 0.2));
            assert!((outside.distance - 0.5).abs() < 1e-5 && outside.normal.dot(Vec3::X) > 0.999);
        }
    }

    /// Ten thousand random edits of a world found it: parry panicked on points whose coordinates cannot be squared.
    #[test]
    fn a_point_beyond_all_numbers_is_far_from_a_mesh() {
        let (vertices, indices) = cube();
        let mesh = mesh(vertices, indices);
        for point in [Vec3::NAN, Vec3::X * f32::INFINITY, Vec3::splat(1e25), Vec3::Y * f32::MIN] {
            let Surface { distance, normal } = mesh.surface(point);
            assert!(distance > 1e15 && normal.is_finite(), "{point}: {distance}");
        }
    }

    /// A roof pushed cloth up that hung beside its eaves: below the plane of its triangles, and taken for inside.
    #[test]
    fn an_open_mesh_has_air_on_both_sides() {
        let corners = vec![Vec3::ZERO, Vec3::Z, Vec3::X];
        let sheet = mesh(corners, vec![[0, 1, 2]]);
        for (point, distance, normal) in [
            (Vec3::new(0.2, 0.3, 0.2), 0.3, Vec3::Y),
            (Vec3::new(0.2, -0.3, 0.2), 0.3, Vec3::NEG_Y),
            (Vec3::new(-0.4, -0.3, 0.2), 0.5, Vec3::new(-0.8, -0.6, 0.0)),
        ] {
            let surface = sheet.surface(point);
            assert!((surface.distance - distance).abs() < 1e-6, "{point}: {surface:?}");
            assert!(surface.normal.dot(normal) > 0.999, "{point}: {surface:?}");
        }
    }

    #[test]
    fn triangles_without_an_area_are_left_out_and_a_mesh_of_them_refused() {
        let (mut vertices, mut indices) = cube();
        vertices.push(Vec3::new(0.0, 1.0, 0.0));
        indices.extend([[0, 0, 1], [8, 8, 8]]);
        let surface = mesh(vertices, indices).surface(Vec3::new(0.1, 1.5, 0.1));
        assert!((surface.distance - 0.5).abs() < 1e-6 && surface.normal.dot(Vec3::Y) > 0.999);
        let line = vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        let flat = TriMesh::new(line, vec![[0, 1, 2]]).expect("a triangle");
        assert!(MeshShape::of_mesh(&flat).is_err());
        let bad = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::splat(f32::NAN)], vec![[0, 1, 2]]);
        assert!(bad.is_err() || MeshShape::of_mesh(&bad.expect("a triangle")).is_err());
    }
}
