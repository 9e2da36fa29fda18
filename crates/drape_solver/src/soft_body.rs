//! The builder of soft solids: a lattice inside a closed mesh, which it carries.
//!
//! ```text
//!     .--''--.        the mesh, and the cells of the lattice whose middle is inside it;
//!    /|_|_|_|_\       sticks along their edges and diagonals, particles at their corners;
//!   | |_|_|_|_|       a vertex of the mesh follows the corners of its cell
//!    \|_|_|_|_/
//!     '--..--'
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{IVec3, Vec3};

use crate::body::Body;
use crate::error::{BuildError, positive};
use crate::particles::Particles;
use crate::settings::SolverSettings;
use crate::shape::Shape;
use crate::topology::{StickKind, StickMaterial, Topology};
use crate::topology_builder::TopologyBuilder;

/// A soft solid in the form of a closed mesh.
#[derive(Clone, Debug)]
pub struct SoftBodyBuilder {
    vertices: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    spacing: f32,
    density: f32,
    stiffness: f32,
    damping: f32,
}

/// Most cells of a lattice along an axis.
const MOST_CELLS: i32 = 128;

impl SoftBodyBuilder {
    /// The solid inside a closed mesh of `vertices` (world, metres) and `faces`, as a lattice of cells of `spacing` metres:
    /// 100 kg/m^3, quite stiff.
    pub fn new(vertices: &[Vec3], faces: &[[u32; 3]], spacing: f32) -> Self {
        let (vertices, faces) = (vertices.to_vec(), faces.to_vec());
        Self { vertices, faces, spacing, density: 100.0, stiffness: 0.95, damping: 1.0 }
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

    /// Builds the body, with a pressure that keeps its volume, and the way in which the mesh follows it.
    ///
    /// # Errors
    /// [`BuildError`] naming what cannot be built: a mesh that is not closed, or cells too small or too large for it.
    pub fn build(self, settings: SolverSettings) -> Result<(Body, Embedding), BuildError> {
        settings.validate()?;
        positive("spacing", self.spacing)?;
        positive("density", self.density)?;
        let (low, high) = self.bounds()?;
        let counts = ((high - low) / self.spacing).ceil().max(Vec3::ONE);
        if counts.max_element() > MOST_CELLS as f32 {
            let limit = u64::from(MOST_CELLS.unsigned_abs()).pow(3);
            return Err(BuildError::TooManyParticles { found: counts.element_product() as u64, limit });
        }
        let counts = counts.as_ivec3();
        // In the middle of the mesh's box.
        let corner = 0.5 * (low + high) - 0.5 * self.spacing * counts.as_vec3();
        let cells = self.cells(corner, counts)?;
        let mut particles_at: BTreeMap<[i32; 3], u32> = BTreeMap::new();
        for &cell in &cells {
            for place in corners_of(cell) {
                particles_at.insert(place.to_array(), 0);
            }
        }
        particles_at.values_mut().zip(0..).for_each(|(index, next)| *index = next);
        let lattice = Lattice { corner, spacing: self.spacing, cells, particles_at };
        let positions: Vec<Vec3> =
            lattice.particles_at.keys().map(|&place| lattice.position(IVec3::from(place))).collect();
        let mut masses = vec![0.0; positions.len()];
        let cell_mass = self.density * self.spacing * self.spacing * self.spacing;
        for place in lattice.cells.iter().flat_map(|&cell| corners_of(cell)) {
            masses[lattice.particle(place) as usize] += 0.125 * cell_mass;
        }
        let inverse_masses: Vec<f32> = masses.iter().map(|mass| 1.0 / mass).collect();
        let particles = Particles::new(corner, &positions, &inverse_masses)?;
        let topology = self.topology(&lattice, &positions)?;
        let embedding = lattice.embedding(&self.vertices);
        let body = Body { pressure: 1.0, ..Body::new(particles, Arc::new(topology), settings) };
        Ok((body, embedding))
    }

    fn bounds(&self) -> Result<(Vec3, Vec3), BuildError> {
        for &vertex in &self.vertices {
            crate::error::finite_vector("a vertex", vertex)?;
        }
        let count = self.vertices.len() as u32;
        if let Some(&index) = self.faces.as_flattened().iter().find(|&&index| index >= count) {
            return Err(BuildError::NoSuchParticle { what: "a face", index, count });
        }
        if self.faces.len() < 4 {
            return Err(BuildError::BadShape {
                reason: "a solid needs a closed mesh of at least four faces",
            });
        }
        let fold = |pick: fn(Vec3, Vec3) -> Vec3, start| self.vertices.iter().fold(start, |p, &q| pick(p, q));
        Ok((fold(Vec3::min, Vec3::INFINITY), fold(Vec3::max, Vec3::NEG_INFINITY)))
    }

    /// The cells whose middle is inside the mesh, in order.
    fn cells(&self, corner: Vec3, counts: IVec3) -> Result<Vec<IVec3>, BuildError> {
        let mesh = parry3d::shape::TriMesh::new(self.vertices.clone(), self.faces.clone());
        let mesh = mesh.map_err(|_| BuildError::BadShape { reason: "its triangles make no mesh" })?;
        let shape = Shape::from_parry(parry3d::shape::SharedShape::new(mesh))?;
        let all = (0..counts.z)
            .flat_map(|z| (0..counts.y).flat_map(move |y| (0..counts.x).map(move |x| [x, y, z])));
        let middle = |cell: IVec3| corner + (cell.as_vec3() + 0.5) * self.spacing;
        let cells: Vec<IVec3> =
            all.map(IVec3::from).filter(|&cell| shape.distance(middle(cell)) < 0.0).collect();
        if cells.is_empty() {
            let reason = "no cell of the lattice has its middle inside the mesh: close the mesh, or take a smaller spacing";
            return Err(BuildError::BadShape { reason });
        }
        Ok(cells)
    }

    fn topology(&self, lattice: &Lattice, positions: &[Vec3]) -> Result<Topology, BuildError> {
        // By kind: edges, diagonals of faces, diagonals of cells.
        let mut families: [Vec<[u32; 2]>; 3] = Default::default();
        for &cell in &lattice.cells {
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
        builder.faces(lattice.surface())?;
        builder.build()
    }
}

/// The eight corners of a cell.
fn corners_of(cell: IVec3) -> [IVec3; 8] {
    core::array::from_fn(|i| cell + IVec3::new(i as i32 & 1, i as i32 >> 1 & 1, i as i32 >> 2 & 1))
}

struct Lattice {
    corner: Vec3,
    spacing: f32,
    cells: Vec<IVec3>,
    particles_at: BTreeMap<[i32; 3], u32>,
}

impl Lattice {
    fn position(&self, place: IVec3) -> Vec3 {
        self.corner + place.as_vec3() * self.spacing
    }

    fn particle(&self, place: IVec3) -> u32 {
        self.particles_at[&place.to_array()]
    }

    fn has(&self, cell: IVec3) -> bool {
        self.cells.binary_search_by_key(&cell_order(cell), |&other| cell_order(other)).is_ok()
    }

    /// Two triangles for each side of a cell that no other cell is at, counter-clockwise seen from outside.
    fn surface(&self) -> Vec<[u32; 3]> {
        let mut faces = Vec::new();
        for &cell in &self.cells {
            for axis in 0..3 {
                for (side, outwards) in [(0, -1), (1, 1)] {
                    let mut way = IVec3::ZERO;
                    way[axis] = outwards;
                    if self.has(cell + way) {
                        continue;
                    }
                    let (mut first, mut second, mut origin) = (IVec3::ZERO, IVec3::ZERO, cell);
                    first[(axis + 1) % 3] = 1;
                    second[(axis + 2) % 3] = 1;
                    origin[axis] += side;
                    let [a, b, c, d] = [origin, origin + first, origin + first + second, origin + second]
                        .map(|place| self.particle(place));
                    let square = if outwards > 0 { [a, b, c, d] } else { [a, d, c, b] };
                    let [a, b, c, d] = square;
                    faces.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
        faces
    }

    /// How vertices follow the lattice: those outside go on as their nearest cell does.
    fn embedding(&self, vertices: &[Vec3]) -> Embedding {
        let of_vertex = |&vertex: &Vec3| {
            let place = (vertex - self.corner) / self.spacing;
            let off = |cell: IVec3| (cell.as_vec3() + 0.5).distance_squared(place);
            let around = place.floor().as_ivec3();
            let nearest = || self.cells.iter().copied().min_by(|&p, &q| off(p).total_cmp(&off(q)));
            let cell = if self.has(around) { around } else { nearest().unwrap_or(around) };
            let part = place - cell.as_vec3();
            let weight = |corner: IVec3| {
                let along =
                    |axis: usize| if corner[axis] > cell[axis] { part[axis] } else { 1.0 - part[axis] };
                along(0) * along(1) * along(2)
            };
            let corners = corners_of(cell);
            Weights { particles: corners.map(|place| self.particle(place)), weights: corners.map(weight) }
        };
        Embedding { vertices: vertices.iter().map(of_vertex).collect() }
    }
}

/// The order in which cells are listed.
fn cell_order(cell: IVec3) -> [i32; 3] {
    [cell.z, cell.y, cell.x]
}

/// How the vertices of a mesh follow the particles of a soft solid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Embedding {
    vertices: Vec<Weights>,
}

/// The corners of a vertex's cell, and what each counts: they sum to 1, and may be negative outside the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Weights {
    particles: [u32; 8],
    weights: [f32; 8],
}

impl Embedding {
    /// Where the vertices are now, in order, relative to the [origin](Particles::origin) of the particles.
    pub fn local_positions<'a>(
        &'a self,
        particles: &'a Particles,
    ) -> impl ExactSizeIterator<Item = Vec3> + 'a {
        self.vertices.iter().map(|Weights { particles: corners, weights }| {
            let corners = corners.iter().zip(weights);
            corners.map(|(&corner, &weight)| particles.local_position(corner as usize) * weight).sum()
        })
    }
}
