//! The points of a detailed mesh follow the particles of a body.
//!
//! ```text
//!             .--*--.           a point on faces follows a curved surface through the normals of
//!      n \ .-'       '-. / n    the corners (Phong tessellation, Boubekeur and Alexa 2008): a
//!         o-----------o         coarse cloth that is bent looks round, not like a polyhedron
//! ```
//!
//! Design: `docs/design/cloth_from_meshes.md` and `docs/design/soft_bodies.md`.

use glam::{DVec3, Vec3};
use parry3d::query::PointQueryWithLocation;
use parry3d::shape::TriMesh;

use crate::build::mesh::check::{WELD_FRACTION, bounds, usable, welded};
use crate::build::mesh::error::MeshError;
use crate::state::topology::Topology;

/// Weights by which points follow the particles of a body: the vertices of a mesh around a soft solid, or those of a
/// detailed mesh on a coarse cloth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Embedding {
    /// One of these two lists is empty.
    in_cells: Vec<CellWeights>,
    on_faces: Vec<FaceWeights>,
    /// For each point the first point in the same place.
    firsts: Vec<u32>,
}

/// The corners of a point's cell, and their weights, which sum to 1. Outside the cell some are negative.
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

/// The part of the way from the triangle to the planes of the corners' normals by which the surface bulges.
const BULGE: f32 = 0.75;

/// The least cosine between the normals of a triangle and of its corners; below it the triangle counts as flat.
const LEAST_CURVED_COSINE: f64 = 0.3;

/// The corners of a point's triangle, their weights, and the offset of the point from the curved surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaceWeights {
    particles: [u32; 3],
    /// They sum to 1. Beside the triangle some are negative.
    weights: [f32; 3],
    /// The offset in parts of the two sides at the first corner, and in metres along the normal.
    offset: Vec3,
    /// True if the triangle is at an edge so sharp that it counts as flat.
    is_sharp: bool,
}

impl FaceWeights {
    /// Weights of `point` on a triangle at rest with these `corners` and `normals`.
    fn new(particles: [u32; 3], corners: [Vec3; 3], normals: [Vec3; 3], point: Vec3) -> Self {
        let [p, q, r] = corners;
        let [a, b, off] = [q - p, r - p, point - p].map(Vec3::as_dvec3);
        let across = a.cross(b);
        let square = across.length_squared();
        if square == 0.0 {
            return Self { particles, weights: [1.0, 0.0, 0.0], offset: Vec3::ZERO, is_sharp: true };
        }
        let (along_a, along_b) = (off.cross(b).dot(across) / square, a.cross(off).dot(across) / square);
        let weights = [1.0 - along_a - along_b, along_a, along_b].map(|weight| weight as f32);
        let unit = across.normalize();
        let is_sharp = normals.iter().any(|normal| normal.as_dvec3().dot(unit) < LEAST_CURVED_COSINE);
        let (curved, normal) = curve(corners, if is_sharp { [unit.as_vec3(); 3] } else { normals }, weights);
        // Expresses the rest by the two sides and the normal, which turn with the triangle.
        let (left, normal) = ((point - curved).as_dvec3(), normal.as_dvec3());
        let volume = across.dot(normal);
        let offset = DVec3::new(left.cross(b).dot(normal), a.cross(left).dot(normal), across.dot(left));
        Self { particles, weights, offset: (offset / volume).as_vec3(), is_sharp }
    }

    fn place(&self, position: impl Fn(usize) -> Vec3, normals: &[Vec3]) -> Vec3 {
        let corners = self.particles.map(|corner| position(corner as usize));
        let [p, q, r] = corners;
        let normals = if self.is_sharp {
            [(q - p).cross(r - p).normalize_or_zero(); 3]
        } else {
            self.particles.map(|corner| normals[corner as usize])
        };
        let (curved, normal) = curve(corners, normals, self.weights);
        curved + (q - p) * self.offset.x + (r - p) * self.offset.y + normal * self.offset.z
    }
}

/// The point of the curved surface over a triangle with these weights, and the normal there.
fn curve([p, q, r]: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3]) -> (Vec3, Vec3) {
    let flat = p + (q - p) * weights[1] + (r - p) * weights[2];
    // Beside the triangle the surface continues the bulge of its side.
    let inside = Vec3::from(weights).max(Vec3::ZERO);
    let inside = inside / inside.element_sum();
    let mut bulge = Vec3::ZERO;
    for ((corner, normal), part) in [p, q, r].into_iter().zip(normals).zip(inside.to_array()) {
        bulge -= normal * ((flat - corner).dot(normal) * part);
    }
    let normal = normals[0] * inside.x + normals[1] * inside.y + normals[2] * inside.z;
    (flat + bulge * BULGE, normal.normalize_or_zero())
}

impl Embedding {
    /// Embeds `points` on the faces of a body. Each point gets the barycentric coordinates of the nearest point on the nearest
    /// whole triangle at rest, and keeps its offset along the normal. The normals of the corners make triangles round. Points and
    /// [rest positions](Topology::rest_position) have the same coordinates, in metres.
    ///
    /// # Errors
    /// [`MeshError`] if a point is not finite, or the body has no faces.
    pub fn on_faces(points: &[Vec3], topology: &Topology) -> Result<Self, MeshError> {
        let rest: Vec<Vec3> = (0..topology.particle_count()).map(|i| topology.rest_position(i)).collect();
        let mut normals = Vec::new();
        write_normals(topology, |i| rest[i], &mut normals);
        // Both sides of a cut have the faces of the cut.
        let mut faces: Vec<[u32; 3]> = topology.contact_faces().collect();
        if faces.is_empty() {
            faces = topology.faces().to_vec();
        }
        let mesh = TriMesh::new(rest, faces.clone());
        let mesh = mesh.map_err(|_| MeshError::NoFaces { vertices: topology.particle_count() })?;
        let on_face = |point: Vec3| {
            let (_, (face, _)) = mesh.project_local_point_and_get_location(point, false);
            let particles = faces[face as usize];
            let corners = particles.map(|corner| topology.rest_position(corner as usize));
            FaceWeights::new(particles, corners, particles.map(|corner| normals[corner as usize]), point)
        };
        let (on_faces, firsts) = Self::of_points(points, on_face)?;
        Ok(Self { in_cells: Vec::new(), on_faces, firsts })
    }

    /// An embedding into cells, from the result of [`of_points`](Self::of_points).
    pub(crate) fn in_cells((in_cells, firsts): (Vec<CellWeights>, Vec<u32>)) -> Self {
        Self { in_cells, on_faces: Vec::new(), firsts }
    }

    /// Calls `embed` for each point. Returns the results, and for each point the first point in the same place; points in the
    /// same place share one result.
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

    /// True if there are no points.
    pub fn is_empty(&self) -> bool {
        self.firsts.is_empty()
    }

    /// For each point the first point in the same place. Both move to the same bits.
    pub fn firsts(&self) -> &[u32] {
        &self.firsts
    }

    /// The particles at the corners of a point's cell; none if the point is on a face.
    pub(crate) fn cell(&self, point: usize) -> Option<[u32; 8]> {
        self.in_cells.get(point).map(|cell| cell.particles)
    }

    /// One of the particles that carry a point.
    ///
    /// # Panics
    /// If `point` is out of range.
    pub fn carrier(&self, point: usize) -> u32 {
        let of_cell = self.in_cells.get(point).map(|cell| cell.particles[0]);
        of_cell.unwrap_or_else(|| self.on_faces[point].particles[0])
    }

    /// Writes the normals of the particles for [`places`](Self::places); none if the points are in cells. Particle `i` is at
    /// `position(i)`.
    pub fn write_normals(
        &self,
        topology: &Topology,
        position: impl Fn(usize) -> Vec3,
        normals: &mut Vec<Vec3>,
    ) {
        normals.clear();
        if !self.on_faces.is_empty() {
            write_normals(topology, position, normals);
        }
    }

    /// The places of the points in order. Particle `i` is at `position(i)`; `normals` come from
    /// [`write_normals`](Self::write_normals).
    pub fn places(&self, position: impl Fn(usize) -> Vec3, normals: &[Vec3]) -> impl Iterator<Item = Vec3> {
        // One of the two lists is empty.
        let (in_cells, on_faces) = (&self.in_cells, &self.on_faces);
        (0..self.len()).map(move |i| match (in_cells.get(i), on_faces.get(i)) {
            (Some(cell), _) => cell.place(&position),
            (None, Some(face)) => face.place(&position, normals),
            (None, None) => Vec3::ZERO,
        })
    }
}

/// Writes the normals of particles: the mean of those of the faces around each, weighted by area.
fn write_normals(topology: &Topology, position: impl Fn(usize) -> Vec3, normals: &mut Vec<Vec3>) {
    normals.clear();
    normals.resize(topology.particle_count(), Vec3::ZERO);
    for face in topology.faces() {
        let [p, q, r] = face.map(|corner| position(corner as usize));
        let normal = (q - p).cross(r - p);
        face.iter().for_each(|&corner| normals[corner as usize] += normal);
    }
    // Scales by the largest component first, as the square of a tiny area underflows.
    let unit =
        |normal: Vec3| (normal / normal.abs().max_element().max(f32::MIN_POSITIVE)).normalize_or_zero();
    normals.iter_mut().for_each(|normal| *normal = unit(*normal));
}
