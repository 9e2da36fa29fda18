//! How the points of a detailed mesh follow the particles of a body.

use glam::Vec3;
use parry3d::query::PointQueryWithLocation;
use parry3d::shape::TriMesh;

use crate::mesh_check::{WELD_FRACTION, bounds, usable, welded};
use crate::mesh_error::MeshError;
use crate::topology::Topology;

/// How points follow the particles of a body: the vertices of a mesh inside a soft solid, or those of a detailed mesh on
/// a coarse cloth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Embedding {
    /// Of these two one is empty.
    in_cells: Vec<CellWeights>,
    on_faces: Vec<FaceWeights>,
    firsts: Vec<u32>,
}

/// The corners of a point's cell, and what each counts: they sum to 1, and may be negative outside the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CellWeights {
    pub particles: [u32; 8],
    pub weights: [f32; 8],
}

impl CellWeights {
    fn place(&self, position: impl Fn(usize) -> Vec3) -> Vec3 {
        let corners = self.particles.iter().zip(self.weights);
        corners.map(|(&corner, weight)| position(corner as usize) * weight).sum()
    }
}

/// The corners of a point's triangle, what each counts, and how far the point is off its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaceWeights {
    particles: [u32; 3],
    /// They sum to 1, and may be negative beside the triangle.
    weights: [f32; 3],
    /// In metres, along the normal.
    offset: f32,
}

impl FaceWeights {
    /// Of a point by a triangle at rest.
    fn new(particles: [u32; 3], [p, q, r]: [Vec3; 3], point: Vec3) -> Self {
        let [a, b, off] = [q - p, r - p, point - p].map(Vec3::as_dvec3);
        let normal = a.cross(b);
        let square = normal.length_squared();
        if square == 0.0 {
            return Self { particles, weights: [1.0, 0.0, 0.0], offset: 0.0 };
        }
        let (along_a, along_b) = (off.cross(b).dot(normal) / square, a.cross(off).dot(normal) / square);
        let weights = [1.0 - along_a - along_b, along_a, along_b].map(|weight| weight as f32);
        Self { particles, weights, offset: (off.dot(normal) / square.sqrt()) as f32 }
    }

    fn place(&self, position: impl Fn(usize) -> Vec3) -> Vec3 {
        let [p, q, r] = self.particles.map(|corner| position(corner as usize));
        let [_, of_q, of_r] = self.weights;
        let (a, b) = (q - p, r - p);
        // Flat ones have no normal.
        p + a * of_q + b * of_r + a.cross(b).normalize_or_zero() * self.offset
    }
}

impl Embedding {
    /// How `points` follow the faces of a body: each hangs on the nearest triangle at rest, by its barycentric coordinates in
    /// the triangle's plane, and as far off that plane as it was. Points and [rest](Topology::rest_position) in the same coordinates, in metres.
    ///
    /// # Errors
    /// [`MeshError`] naming a point that is nowhere, or a body without faces.
    pub fn on_faces(points: &[Vec3], topology: &Topology) -> Result<Self, MeshError> {
        let rest: Vec<Vec3> = (0..topology.particle_count()).map(|i| topology.rest_position(i)).collect();
        let mesh = TriMesh::new(rest, topology.faces().to_vec());
        let mesh = mesh.map_err(|_| MeshError::NoFaces { vertices: topology.particle_count() })?;
        let on_face = |point: Vec3| {
            let (_, (face, _)) = mesh.project_local_point_and_get_location(point, false);
            let particles = topology.faces()[face as usize];
            FaceWeights::new(
                particles,
                particles.map(|corner| topology.rest_position(corner as usize)),
                point,
            )
        };
        let (on_faces, firsts) = Self::of_points(points, on_face)?;
        Ok(Self { in_cells: Vec::new(), on_faces, firsts })
    }

    /// Of points in cells, as [`of_points`](Self::of_points) gives them.
    pub(crate) fn in_cells((in_cells, firsts): (Vec<CellWeights>, Vec<u32>)) -> Self {
        Self { in_cells, on_faces: Vec::new(), firsts }
    }

    /// What `embed` makes of each point, and for each the first in the same place, of which both have the same.
    pub(crate) fn of_points<T: Copy>(
        points: &[Vec3],
        embed: impl Fn(Vec3) -> T,
    ) -> Result<(Vec<T>, Vec<u32>), MeshError> {
        let all: Vec<u32> = (0..points.len() as u32).collect();
        for (&vertex, &point) in all.iter().zip(points) {
            usable(vertex, point)?;
        }
        if points.is_empty() {
            return Err(MeshError::NoVertices);
        }
        let (low, high) = bounds(points, &all);
        let firsts = welded(points, &all, (high - low).max_element() * WELD_FRACTION);
        let mut embedded: Vec<T> = Vec::with_capacity(points.len());
        for (vertex, &first) in firsts.iter().enumerate() {
            let known = embedded.get(first as usize).copied();
            embedded.push(known.unwrap_or_else(|| embed(points[vertex])));
        }
        Ok((embedded, firsts))
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.firsts.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.firsts.is_empty()
    }

    /// For each point the first that was in the same place: they go together, to the bit.
    pub fn firsts(&self) -> &[u32] {
        &self.firsts
    }

    /// The corners of the cell that a point goes with, by the index of their particles; none if it is on a face.
    pub(crate) fn cell(&self, point: usize) -> Option<[u32; 8]> {
        self.in_cells.get(point).map(|cell| cell.particles)
    }

    /// Where the points are, in order, when particle `i` is at `position(i)`.
    pub fn places(&self, position: impl Fn(usize) -> Vec3) -> impl Iterator<Item = Vec3> {
        // One of them is empty.
        let position = move |i| position(i);
        let (in_cells, on_faces) = (&self.in_cells, &self.on_faces);
        (0..self.len()).map(move |i| match (in_cells.get(i), on_faces.get(i)) {
            (Some(cell), _) => cell.place(&position),
            (None, Some(face)) => face.place(&position),
            (None, None) => Vec3::ZERO,
        })
    }
}
