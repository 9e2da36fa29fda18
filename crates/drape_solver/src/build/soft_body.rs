//! The builder of soft solids: a lattice of cells inside a closed mesh carries the mesh.
//!
//! ```text
//!     .--''--.        the mesh, and the cells of the lattice with their middle inside it;
//!    /|_|_|_|_\       sticks along their edges and diagonals, particles at their corners;
//!   | |_|_|_|_|       a vertex of the mesh follows the corners of its cell
//!    \|_|_|_|_/
//!     '--..--'
//! ```
//!
//! Design: `docs/design/soft_bodies.md`.

use std::sync::Arc;

use glam::{Affine3A, IVec3, Vec3};

use crate::build::embedding::Embedding;
use crate::build::mesh::check::{WELD_FRACTION, bounds, extent, usable, used_vertices, welded};
use crate::build::mesh::error::MeshError;
use crate::build::mesh::surface::MeshSurface;
use crate::build::soft_lattice::{LatticeMesh, SoftLattice, corners_of};
use crate::build::topology_builder::TopologyBuilder;
use crate::constants::MAX_MAGNITUDE;
use crate::error::{BuildError, in_range, positive};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::{StickKind, StickMaterial, Topology};

/// A soft solid in the form of a closed mesh.
///
/// Divides the box around the mesh into equal cells; those with their middle inside the mesh make the solid. Welds vertices
/// in the same place, so that seams of texture coordinates and normals are not holes. Parts of the mesh may overlap.
#[derive(Clone, Debug)]
pub struct SoftBodyBuilder {
    vertices: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    to_world: Affine3A,
    spacing: f32,
    density: f32,
    stiffness: f32,
    damping: f32,
    pins: Vec<u32>,
}

/// The soft solid of a closed mesh.
#[derive(Clone, Debug)]
pub struct SoftSolid {
    /// The corners of the cells.
    pub particles: Particles,
    /// The sticks and faces of the particles.
    pub topology: Topology,
    /// The cells.
    pub lattice: SoftLattice,
    /// Moves the vertices of the mesh with the particles.
    pub embedding: Embedding,
}

/// The greatest number of cells of a lattice along an axis.
const MOST_CELLS: u32 = 128;
/// A mesh may exceed a whole number of cells by this part of a cell: rounding then adds no further cell.
const SLACK: f32 = 1e-3;

impl SoftBodyBuilder {
    /// The solid inside a closed mesh of `vertices` (metres) and `faces`, which may be clockwise or counter-clockwise. Cells
    /// are at most `spacing` metres wide. 100 kg/m^3, quite stiff.
    pub fn new(vertices: &[Vec3], faces: &[[u32; 3]], spacing: f32) -> Self {
        Self {
            vertices: vertices.to_vec(),
            faces: faces.to_vec(),
            to_world: Affine3A::IDENTITY,
            spacing,
            density: 100.0,
            stiffness: 0.95,
            damping: 1.0,
            pins: Vec::new(),
        }
    }

    /// Sets the transform from the mesh's coordinates to the world; the identity by default. The lattice lies along the axes
    /// of the mesh under any rotation.
    pub fn transform(mut self, to_world: Affine3A) -> Self {
        self.to_world = to_world;
        self
    }

    /// Mass per volume in kg/m^3, above zero.
    pub fn density(mut self, density: f32) -> Self {
        self.density = density;
        self
    }

    /// Stiffness (0..=1) of all sticks.
    pub fn stiffness(mut self, stiffness: f32) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Damping along all sticks in 1/s.
    pub fn damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }

    /// Pins the corners of the cell around a vertex.
    pub fn pin(mut self, vertex: u32) -> Self {
        self.pins.push(vertex);
        self
    }

    /// Builds the body, with a pressure that keeps its volume, and the embedding that moves the mesh with it.
    ///
    /// # Errors
    /// [`MeshError`] that names the fault, such as a mesh that is not closed, or cells too small or too large for it.
    pub fn build(self, settings: BodySettings) -> Result<(Body, Embedding), MeshError> {
        settings.validate()?;
        let SoftSolid { particles, topology, embedding, .. } = self.build_parts()?;
        let body = Body { pressure: 1.0, ..Body::new(particles, Arc::new(topology), settings) };
        Ok((body, embedding))
    }

    /// Builds particles and topology, the cells, and the embedding that moves the mesh with them.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn build_parts(self) -> Result<SoftSolid, MeshError> {
        let used = self.validate()?;
        // Gives the mesh its lengths in the world, without its rotation.
        let [x, y, z] = self.to_world.matrix3.to_cols_array_2d().map(|axis| Vec3::from(axis).length());
        let scale = Vec3::new(x, y, z);
        let positions: Vec<Vec3> = self.vertices.iter().map(|&vertex| vertex * scale).collect();
        let extent = extent(&positions, &used)?;
        let welded = welded(&positions, &used, extent * WELD_FRACTION);
        let faces = self.faces.iter().map(|face| face.map(|corner| welded[corner as usize]));
        let surface = MeshSurface::new(&positions, faces);
        if surface.faces.is_empty() {
            return Err(MeshError::NoArea { faces: self.faces.len() });
        }
        let edges = surface.open_edges();
        if edges > 0 {
            return Err(MeshError::NotClosed { edges });
        }
        // Triangles without an area count too: they close gaps between others.
        let faces = [surface.faces, surface.lines].concat();
        let bounds = bounds(&positions, &used);
        let counts = self.counts(bounds.1 - bounds.0)?;
        let mesh = LatticeMesh { positions: &positions, faces: &faces, bounds };
        let lattice = SoftLattice::inside(&mesh, counts, scale);
        if lattice.cell_count() == 0 {
            return Err(MeshError::NoCells { spacing: self.spacing });
        }
        // If parts overlap, or differ in their sense, the sum over triangles is not the volume.
        let (of_mesh, of_cells) = (volume(&positions, &faces), lattice.volume());
        let is_plain = (0.5 * of_cells..2.0 * of_cells).contains(&of_mesh);
        let volume = if is_plain { of_mesh } else { of_cells };
        let sheared = f64::from(self.to_world.matrix3.determinant() / scale.element_product()).abs();
        let vertices: Vec<Vec3> = welded.iter().map(|&vertex| self.vertices[vertex as usize]).collect();
        let embedding = lattice.embed(&vertices)?;
        let positions = lattice.positions(&self.to_world);
        let inverse_masses = self.inverse_masses(&lattice, &embedding, volume * sheared);
        Ok(SoftSolid {
            particles: Particles::new(positions[0], &positions, &inverse_masses)?,
            topology: self.topology(&lattice, &positions)?,
            lattice,
            embedding,
        })
    }

    /// Checks all values. Returns the vertices that are corners of triangles.
    fn validate(&self) -> Result<Vec<u32>, MeshError> {
        positive("spacing", self.spacing)?;
        positive("density", self.density)?;
        in_range("stiffness", self.stiffness, 0.0, 1.0)?;
        in_range("damping", self.damping, 0.0, MAX_MAGNITUDE)?;
        let used = used_vertices(&self.vertices, &self.faces)?;
        for (vertex, &position) in (0..).zip(&self.vertices) {
            usable(vertex, position)?;
            usable(vertex, self.to_world.transform_point3(position))?;
        }
        let count = self.vertices.len() as u32;
        match self.pins.iter().find(|&&pin| pin >= count) {
            Some(&index) => Err(BuildError::NoSuchParticle { what: "a pin", index, count }.into()),
            None => Ok(used),
        }
    }

    /// The number of cells along each axis of a box of this size.
    fn counts(&self, size: Vec3) -> Result<IVec3, MeshError> {
        let counts = (size / self.spacing - SLACK).ceil().max(Vec3::ONE);
        let cells = counts.max_element();
        if cells > MOST_CELLS as f32 {
            return Err(MeshError::TooManyCells { spacing: self.spacing, cells, most: MOST_CELLS });
        }
        Ok(counts.as_ivec3())
    }

    /// Inverse masses in 1/kg. The particles together weigh as much as the mesh, and each cell gives an eighth of its mass to
    /// each corner.
    fn inverse_masses(&self, lattice: &SoftLattice, embedding: &Embedding, volume: f64) -> Vec<f32> {
        let mass = f64::from(self.density) * volume;
        let part = mass / (8 * lattice.cell_count()) as f64;
        let mut masses = vec![0.0_f64; lattice.particle_count()];
        for place in lattice.cells().iter().flat_map(|&cell| corners_of(cell)) {
            masses[lattice.particle(place) as usize] += part;
        }
        let mut inverse_masses: Vec<f32> = masses.iter().map(|mass| (1.0 / mass) as f32).collect();
        for corner in self.pins.iter().filter_map(|&pin| embedding.cell(pin as usize)).flatten() {
            inverse_masses[corner as usize] = 0.0;
        }
        inverse_masses
    }

    fn topology(&self, lattice: &SoftLattice, positions: &[Vec3]) -> Result<Topology, BuildError> {
        // Edges, diagonals of faces, and diagonals of cells.
        let mut families: [Vec<[u32; 2]>; 3] = Default::default();
        for &cell in lattice.cells() {
            let corners = corners_of(cell);
            for (i, &from) in corners.iter().enumerate() {
                for &to in &corners[i + 1..] {
                    let kind = (to - from).abs().element_sum() as usize - 1;
                    families[kind].push([from, to].map(|place| lattice.particle(place)));
                }
            }
        }
        let kinds = [StickKind::Structural, StickKind::Shear, StickKind::Bend];
        let mut builder = TopologyBuilder::new(positions);
        for (mut sticks, kind) in families.into_iter().zip(kinds) {
            sticks.iter_mut().for_each(|ends| ends.sort_unstable());
            sticks.sort_unstable();
            sticks.dedup();
            let material = StickMaterial {
                stiffness: self.stiffness,
                damping: self.damping,
                ..StickMaterial::rigid(kind)
            };
            builder.family(material, sticks)?;
        }
        let mut faces = lattice.surface();
        if self.to_world.matrix3.determinant() < 0.0 {
            // A mirrored mesh has its faces the other way round.
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        builder.faces(faces)?;
        builder.build()
    }
}

/// The volume inside a closed surface of triangles in cubic metres, whether clockwise or counter-clockwise.
fn volume(positions: &[Vec3], faces: &[[u32; 3]]) -> f64 {
    let about = faces.first().map_or(Vec3::ZERO, |face| positions[face[0] as usize]);
    let of_face = |face: &[u32; 3]| {
        let [p, q, r] = face.map(|corner| (positions[corner as usize] - about).as_dvec3());
        p.dot(q.cross(r))
    };
    (faces.iter().map(of_face).sum::<f64>() / 6.0).abs()
}
