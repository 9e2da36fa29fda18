//! The builder of cloths from any mesh.
//!
//! Design: `docs/design/cloth_from_meshes.md`.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;

use crate::build::cloth::ClothMaterial;
use crate::build::mesh::check::{WELD_FRACTION, extent, used_vertices, welded};
use crate::build::mesh::error::{MeshError, MeshRepairs};
use crate::build::mesh::surface::{MeshSurface, double_area};
use crate::build::topology_builder::TopologyBuilder;
use crate::build::weave::{Weave, by_class};
use crate::constants::MAX_MAGNITUDE;
use crate::error::{BuildError, in_range, positive};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::{StickKind, StickMaterial, Topology};

/// Builds a cloth from the triangles of any mesh.
///
/// Vertices in the same place become one particle, so that the cloth does not open at seams of texture coordinates and
/// normals. Edges become structural sticks, which resist shear too. A bend stick joins the corners that face each other
/// across an edge. Each triangle gives a third of its mass to each of its corners.
///
/// ```
/// use drape_solver::glam::Vec3;
/// use drape_solver::{MeshClothBuilder, BodySettings};
///
/// # fn main() -> Result<(), drape_solver::MeshError> {
/// // Two triangles that share an edge, with three vertices each.
/// let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y];
/// let cloth = MeshClothBuilder::new(vec![a, b, c, d, c, b], vec![[0, 1, 2], [3, 4, 5]]).pin(2).build_parts()?;
/// assert_eq!(cloth.particles.len(), 4);
/// assert_eq!(cloth.particle_of_vertex[1], cloth.particle_of_vertex[5]);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct MeshClothBuilder {
    positions: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    weld_distance: Option<f32>,
    material: ClothMaterial,
    pins: Vec<u32>,
    weave: Option<Weave>,
    paint: Vec<f32>,
}

/// The parts of a cloth that was built from a mesh.
#[derive(Clone, Debug)]
pub struct MeshCloth {
    /// The particles, in the order in which triangles first name them.
    pub particles: Particles,
    /// The sticks, faces and tethers of the particles.
    pub topology: Topology,
    /// The particle of each vertex of the mesh; none if the vertex is not a corner of a triangle with an area.
    pub particle_of_vertex: Vec<Option<u32>>,
    /// Faults of the mesh that were repaired.
    pub repairs: MeshRepairs,
}

impl MeshClothBuilder {
    /// A cloth of triangles `faces`, counter-clockwise seen from the front, between vertices at `positions` (world, metres).
    pub fn new(positions: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Self {
        Self {
            positions,
            faces,
            weld_distance: None,
            material: ClothMaterial::default(),
            pins: Vec::new(),
            weave: None,
            paint: Vec::new(),
        }
    }

    /// Sets density, stiffness and damping. Shear stiffness has no effect.
    pub fn material(mut self, material: ClothMaterial) -> Self {
        self.material = material;
        self
    }

    /// Sets the distance in metres within which vertices become one particle; 0 welds only exactly equal positions. By default
    /// a hundred-thousandth of the mesh's length.
    pub fn weld_distance(mut self, distance: f32) -> Self {
        self.weld_distance = Some(distance);
        self
    }

    /// Pins the particle of a vertex.
    pub fn pin(mut self, vertex: u32) -> Self {
        self.pins.push(vertex);
        self
    }

    /// Gives edges the stiffness of their direction in the weave. Without a weave all edges are alike.
    pub fn weave(mut self, weave: Weave) -> Self {
        self.weave = Some(weave);
        self
    }

    /// Softens the cloth by `paint`, a number from 0 (softest) to 1 (unchanged) for each vertex. It adds `(1 - paint)^3` to the
    /// compliance of edges and bends, where a stiffness `s` has the compliance `(1 - s) / s`. So 0.9 makes a rigid edge 0.999
    /// stiff, 0.5 makes it 0.89, and 0 makes it 0.5. Paint is rounded to fifteenths.
    pub fn painted_stiffness(mut self, paint: Vec<f32>) -> Self {
        self.paint = paint;
        self
    }

    /// Builds particles, topology, and the map from vertices to particles.
    ///
    /// # Errors
    /// [`MeshError`] that names the fault.
    pub fn build_parts(self) -> Result<MeshCloth, MeshError> {
        let used = self.validate()?;
        let extent = extent(&self.positions, &used)?;
        let distance = self.weld_distance.unwrap_or(extent * WELD_FRACTION);
        let welded = welded(&self.positions, &used, distance);
        let faces = self.faces.iter().map(|face| face.map(|corner| welded[corner as usize]));
        let mut surface = MeshSurface::new(&self.positions, faces);
        if surface.faces.is_empty() {
            return Err(MeshError::NoArea { faces: self.faces.len() });
        }
        let numbering = Numbering::new(&mut surface, self.positions.len());
        let particle_of_vertex = self.particles_of_vertices(&used, &welded, &numbering);
        surface.repairs.unused_vertices = particle_of_vertex.iter().filter(|number| number.is_none()).count();

        let positions: Vec<Vec3> =
            numbering.vertices.iter().map(|&vertex| self.positions[vertex as usize]).collect();
        let mut inverse_masses = inverse_masses(&positions, &surface.faces, self.material.areal_density);
        let mut pins: Vec<u32> =
            self.pins.iter().filter_map(|&pin| particle_of_vertex[pin as usize]).collect();
        pins.sort_unstable();
        pins.dedup();
        pins.iter().for_each(|&pin| inverse_masses[pin as usize] = 0.0);
        Ok(MeshCloth {
            particles: Particles::new(positions[0], &positions, &inverse_masses)?,
            topology: self.topology(&positions, &surface, &pins, &particle_of_vertex)?,
            particle_of_vertex,
            repairs: surface.repairs,
        })
    }

    /// Builds a body with these settings.
    ///
    /// # Errors
    /// [`MeshError`] that names the fault.
    pub fn build(self, settings: BodySettings) -> Result<Body, MeshError> {
        settings.validate()?;
        let MeshCloth { particles, topology, .. } = self.build_parts()?;
        Ok(Body::new(particles, Arc::new(topology), settings))
    }

    /// Checks all values. Returns the vertices that are corners of triangles, in the order of the triangles.
    fn validate(&self) -> Result<Vec<u32>, MeshError> {
        let count = self.positions.len();
        positive("areal_density", self.material.areal_density)?;
        in_range("stretch stiffness", self.material.stretch_stiffness, 0.0, 1.0)?;
        in_range("bend stiffness", self.material.bend_stiffness, 0.0, 1.0)?;
        in_range("damping", self.material.damping, 0.0, MAX_MAGNITUDE)?;
        if let Some(distance) = self.weld_distance {
            in_range("weld_distance", distance, 0.0, MAX_MAGNITUDE)?;
        }
        let used = used_vertices(&self.positions, &self.faces)?;
        if let Some(weave) = &self.weave {
            weave.validate(count)?;
        }
        if !self.paint.is_empty() && self.paint.len() != count {
            let reason = "a painted stiffness needs a number at every vertex";
            return Err(BuildError::BadShape { reason }.into());
        }
        if let Some(&index) = self.pins.iter().find(|&&pin| pin as usize >= count) {
            return Err(BuildError::NoSuchParticle { what: "a pin", index, count: count as u32 }.into());
        }
        Ok(used)
    }

    fn particles_of_vertices(&self, used: &[u32], welded: &[u32], numbering: &Numbering) -> Vec<Option<u32>> {
        let mut particles = vec![None; self.positions.len()];
        for &vertex in used {
            particles[vertex as usize] = numbering.numbers[welded[vertex as usize] as usize];
        }
        particles
    }

    /// The paint of each particle: the mean of that of its vertices.
    fn paint_of_particles(&self, count: usize, particle_of_vertex: &[Option<u32>]) -> Vec<f32> {
        let mut sums = vec![(0.0_f32, 0.0_f32); count];
        for (&value, particle) in self.paint.iter().zip(particle_of_vertex) {
            if let &Some(particle) = particle {
                let (sum, vertices) = &mut sums[particle as usize];
                (*sum, *vertices) = (*sum + value, *vertices + 1.0);
            }
        }
        sums.into_iter().map(|(sum, vertices)| if vertices > 0.0 { sum / vertices } else { 1.0 }).collect()
    }

    /// Adds the sticks family by family: in this order relaxation does not gain energy.
    fn topology(
        &self,
        positions: &[Vec3],
        surface: &MeshSurface,
        pins: &[u32],
        particle_of_vertex: &[Option<u32>],
    ) -> Result<Topology, BuildError> {
        let material = |kind, stiffness| StickMaterial {
            stiffness,
            damping: self.material.damping,
            ..StickMaterial::rigid(kind)
        };
        let mut builder = TopologyBuilder::new(positions);
        let weave = self.weave.as_ref();
        let directions = weave
            .map(|weave| weave.of_edges(&self.faces, &self.positions, particle_of_vertex))
            .unwrap_or_default();
        let paint = self.paint_of_particles(positions.len(), particle_of_vertex);
        for (class, edges) in by_class(&surface.edges, &paint, &directions) {
            let stiffness = class.stiffness(self.material.stretch_stiffness, weave);
            builder.family(material(StickKind::Structural, stiffness), edges)?;
        }
        // Along the edges alone: bend sticks are shorter than the way over the surface.
        builder.geodesic_tethers(pins)?;
        for (class, bends) in by_class(&surface.bends, &paint, &BTreeMap::new()) {
            builder.family(
                material(StickKind::Bend, class.stiffness(self.material.bend_stiffness, None)),
                bends,
            )?;
        }
        builder.faces(surface.faces.iter().copied())?;
        builder.bending(self.material.bending_rigidity)?.bending_friction(self.material.bending_friction)?;
        builder.build()
    }
}

/// Numbers the corners of a surface in the order in which its triangles name them. Split vertices do not change the
/// numbers.
struct Numbering {
    /// The number of each vertex that is a corner.
    numbers: Vec<Option<u32>>,
    /// The vertex of each number.
    vertices: Vec<u32>,
}

impl Numbering {
    /// Numbers the corners, and replaces the vertices of `surface` by their numbers.
    fn new(surface: &mut MeshSurface, vertex_count: usize) -> Self {
        let mut numbering = Self { numbers: vec![None; vertex_count], vertices: Vec::new() };
        let MeshSurface { faces, edges, bends, .. } = surface;
        faces.iter_mut().flatten().for_each(|corner| *corner = numbering.number(*corner));
        edges.iter_mut().chain(bends).flatten().for_each(|end| *end = numbering.number(*end));
        numbering
    }

    fn number(&mut self, vertex: u32) -> u32 {
        *self.numbers[vertex as usize].get_or_insert_with(|| {
            self.vertices.push(vertex);
            self.vertices.len() as u32 - 1
        })
    }
}

fn inverse_masses(positions: &[Vec3], faces: &[[u32; 3]], areal_density: f32) -> Vec<f32> {
    let mut masses = vec![0.0_f64; positions.len()];
    for face in faces {
        let mass =
            f64::from(areal_density) * 0.5 * double_area(face.map(|corner| positions[corner as usize]));
        face.iter().for_each(|&corner| masses[corner as usize] += mass / 3.0);
    }
    masses.into_iter().map(|mass| (1.0 / mass) as f32).collect()
}
