//! The builder of rectangular cloths.
//!
//! Design: `docs/design/relaxation.md`.

use std::sync::Arc;

use glam::Vec3;

use crate::build::membrane::{SpringConstants, stiffness_of};
use crate::build::topology_builder::TopologyBuilder;
use crate::error::{BuildError, finite_vector, in_range, positive, right_angled};
use crate::state::bending_friction::BendingFriction;
use crate::state::bends::BendingRigidity;
use crate::state::body::Body;
use crate::state::membrane::MembraneStiffness;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::{StickKind, StickMaterial, Topology};

/// The greatest number of particles that one cloth may have.
pub const MAX_PARTICLES: u64 = 1 << 26;

/// An edge of a rectangular cloth; `Top` is row 0, `Left` column 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Edge {
    /// The first row.
    Top,
    /// The last row.
    Bottom,
    /// The first column.
    Left,
    /// The last column.
    Right,
}

/// Mass of a cloth, and stiffness and damping of its three kinds of sticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothMaterial {
    /// Mass per area in kg/m^2.
    pub areal_density: f32,
    /// Stiffness of structural sticks, 0 (slack) to 1 (rigid): resists stretching.
    pub stretch_stiffness: f32,
    /// Stiffness of shear sticks, 0 to 1: resists skewing.
    pub shear_stiffness: f32,
    /// Stiffness of bend sticks, 0 to 1: resists folding.
    pub bend_stiffness: f32,
    /// Rigidity in bending, as a laboratory measures it; none by default. It acts besides the bend sticks, and does not depend on
    /// the spacing.
    pub bending_rigidity: BendingRigidity,
    /// Friction that holds a curvature, as a laboratory measures it; none by default. It acts beside a rigidity alone.
    pub bending_friction: BendingFriction,
    /// Resistance in its plane, as a laboratory measures it; none by default. Of a cloth that is a grid, it takes the place of the
    /// stretch and shear stiffnesses where it is not zero.
    pub membrane_stiffness: MembraneStiffness,
    /// Damping along all sticks in 1/s.
    pub damping: f32,
}

impl Default for ClothMaterial {
    /// A cotton of 0.25 kg/m^2 that does not stretch, and folds easily.
    fn default() -> Self {
        Self {
            areal_density: 0.25,
            stretch_stiffness: 1.0,
            shear_stiffness: 0.7,
            bend_stiffness: 0.1,
            bending_rigidity: BendingRigidity::default(),
            bending_friction: BendingFriction::default(),
            membrane_stiffness: MembraneStiffness::default(),
            damping: 0.0,
        }
    }
}

/// A rectangular cloth of `columns` x `rows` particles.
///
/// ```text
///   origin  column 0 ... columns - 1
///        o--->-----------o   row 0 (top)      along `right`
///        |   right       |
///        v down          |
///        o---------------o   row rows - 1     along `down`
/// ```
///
/// Particle `row * columns + column` lies at `origin + right * (column * dx) + down * (row * dy)`. Each has the mass of
/// the area nearest to it: a particle on an edge weighs half as much as one inside, a corner a quarter.
#[derive(Clone, Debug)]
pub struct ClothBuilder {
    size: [f32; 2],
    columns: u32,
    rows: u32,
    origin: Vec3,
    right: Vec3,
    down: Vec3,
    material: ClothMaterial,
    pins: Vec<u32>,
}

impl ClothBuilder {
    /// A cloth of `width` x `height` metres and `columns` x `rows` particles. It hangs down in the XY plane and faces +Z,
    /// with its upper left corner at the world's origin.
    pub fn new(width: f32, height: f32, columns: u32, rows: u32) -> Self {
        Self {
            size: [width, height],
            columns,
            rows,
            origin: Vec3::ZERO,
            right: Vec3::X,
            down: Vec3::NEG_Y,
            material: ClothMaterial::default(),
            pins: Vec::new(),
        }
    }

    /// Puts particle 0 at `origin` (metres). Rows run along `right` and columns along `down`, which have unit length and are
    /// at right angles.
    pub fn placed(mut self, origin: Vec3, right: Vec3, down: Vec3) -> Self {
        (self.origin, self.right, self.down) = (origin, right, down);
        self
    }

    /// Sets density, stiffness and damping.
    pub fn material(mut self, material: ClothMaterial) -> Self {
        self.material = material;
        self
    }

    /// Pins one particle.
    pub fn pin(mut self, index: u32) -> Self {
        self.pins.push(index);
        self
    }

    /// Pins a whole edge.
    pub fn pin_edge(self, edge: Edge) -> Self {
        let (columns, rows) = (self.columns, self.rows);
        self.pin_where(|column, row, _| match edge {
            Edge::Top => row == 0,
            Edge::Bottom => row + 1 == rows,
            Edge::Left => column == 0,
            Edge::Right => column + 1 == columns,
        })
    }

    /// Pins all particles for which `predicate(column, row, position)` is true.
    pub fn pin_where(mut self, predicate: impl Fn(u32, u32, Vec3) -> bool) -> Self {
        if self.particle_count() <= MAX_PARTICLES {
            for row in 0..self.rows {
                for column in 0..self.columns {
                    if predicate(column, row, self.position(column, row)) {
                        self.pins.push(self.index(column, row));
                    }
                }
            }
        }
        self
    }

    /// Builds the particles and the topology.
    ///
    /// # Errors
    /// [`BuildError`] that names the invalid value.
    pub fn build_parts(mut self) -> Result<(Particles, Topology), BuildError> {
        self.validate()?;
        self.pins.sort_unstable();
        self.pins.dedup();
        let positions: Vec<Vec3> =
            self.cells(self.columns, self.rows).map(|(column, row)| self.position(column, row)).collect();
        let mut inverse_masses: Vec<f32> = self
            .cells(self.columns, self.rows)
            .map(|(column, row)| 1.0 / self.particle_mass(column, row))
            .collect();
        for &pin in &self.pins {
            let count = inverse_masses.len() as u32;
            let slot = inverse_masses.get_mut(pin as usize);
            *slot.ok_or(BuildError::NoSuchParticle { what: "a pin", index: pin, count })? = 0.0;
        }
        let topology = self.topology(&positions)?;
        let particles = Particles::new(self.origin, &positions, &inverse_masses)?;
        Ok((particles, topology))
    }

    /// Builds a body with these settings.
    ///
    /// # Errors
    /// [`BuildError`] that names the invalid value.
    pub fn build(self, settings: BodySettings) -> Result<Body, BuildError> {
        settings.validate()?;
        let (particles, topology) = self.build_parts()?;
        Ok(Body::new(particles, Arc::new(topology), settings))
    }

    fn validate(&self) -> Result<(), BuildError> {
        positive("width", self.size[0])?;
        positive("height", self.size[1])?;
        finite_vector("origin", self.origin)?;
        finite_vector("right", self.right)?;
        finite_vector("down", self.down)?;
        positive("areal_density", self.material.areal_density)?;
        in_range("damping", self.material.damping, 0.0, 1e6)?;
        for found in [self.columns, self.rows] {
            if found < 2 {
                let body = "each side of a cloth";
                return Err(BuildError::TooFewParticles { body, needed: 2, found });
            }
        }
        if self.particle_count() > MAX_PARTICLES {
            let found = self.particle_count();
            return Err(BuildError::TooManyParticles { found, limit: MAX_PARTICLES });
        }
        right_angled(self.right, self.down)
    }

    /// Adds the sticks family by family: in this order relaxation does not gain energy.
    fn topology(&self, positions: &[Vec3]) -> Result<Topology, BuildError> {
        let (c, r) = (self.columns, self.rows);
        let material = |kind, stiffness| StickMaterial {
            stiffness,
            damping: self.material.damping,
            ..StickMaterial::rigid(kind)
        };
        let springs = SpringConstants::new(self.material.membrane_stiffness, self.spacing())?;
        let mass = f64::from(self.square_mass());
        let or_spring =
            |number: f32, spring: Option<f64>| spring.map_or(number, |spring| stiffness_of(spring, mass));
        let [along_rows, along_columns] = springs.along.map(|spring| {
            material(StickKind::Structural, or_spring(self.material.stretch_stiffness, spring))
        });
        let shear = material(StickKind::Shear, or_spring(self.material.shear_stiffness, springs.diagonal));
        let bend = material(StickKind::Bend, self.material.bend_stiffness);
        let mut builder = TopologyBuilder::grid(positions, c, r)?;
        builder
            .grid_family(along_rows, [1, 0])?
            .grid_family(along_columns, [0, 1])?
            .grid_family(shear, [1, 1])?
            .grid_family(shear, [-1, 1])?
            .grid_family(bend, [2, 0])?
            .grid_family(bend, [0, 2])?
            .bending(self.material.bending_rigidity)?
            .bending_friction(self.material.bending_friction)?
            .springs(springs)
            .faces(self.faces())?;
        if springs.along == [None; 2] {
            // They would keep an elastic cloth from stretching.
            builder.straight_tethers(&self.pins)?;
        }
        builder.build()
    }

    /// Two triangles for each square, counter-clockwise seen from the front (`right` x `-down`). Diagonals alternate, so that
    /// the cloth folds alike along both.
    fn faces(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.cells(self.columns - 1, self.rows - 1).flat_map(|(column, row)| {
            let a = self.index(column, row);
            let b = self.index(column + 1, row);
            let c = self.index(column, row + 1);
            let d = self.index(column + 1, row + 1);
            if (column + row) % 2 == 0 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] }
        })
    }

    fn cells(&self, columns: u32, rows: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
        (0..rows).flat_map(move |row| (0..columns).map(move |column| (column, row)))
    }

    fn particle_count(&self) -> u64 {
        u64::from(self.columns) * u64::from(self.rows)
    }

    fn index(&self, column: u32, row: u32) -> u32 {
        row * self.columns + column
    }

    fn spacing(&self) -> [f32; 2] {
        [self.size[0] / (self.columns.max(2) - 1) as f32, self.size[1] / (self.rows.max(2) - 1) as f32]
    }

    fn position(&self, column: u32, row: u32) -> Vec3 {
        let [dx, dy] = self.spacing();
        self.origin + self.right * (dx * column as f32) + self.down * (dy * row as f32)
    }

    fn particle_mass(&self, column: u32, row: u32) -> f32 {
        let share = |i: u32, count: u32| if i == 0 || i + 1 == count { 0.5 } else { 1.0 };
        self.square_mass() * share(column, self.columns) * share(row, self.rows)
    }

    /// The mass of the cloth between four particles, and so of a particle inside.
    fn square_mass(&self) -> f32 {
        let [dx, dy] = self.spacing();
        self.material.areal_density * dx * dy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloth_has_the_sticks_faces_and_mass_of_its_grid() {
        let cloth = ClothBuilder::new(2.0, 1.0, 6, 4);
        let (particles, topology) = cloth.build_parts().expect("valid");
        let structural = 5 * 4 + 6 * 3;
        let shear = 2 * 5 * 3;
        let bend = 4 * 4 + 6 * 2;
        assert_eq!(topology.stick_count(), structural + shear + bend);
        assert_eq!(topology.faces().len(), 2 * 5 * 3);
        let mass = crate::state::measure::mass(&particles);
        assert!((mass - 0.25 * 2.0).abs() < 1e-6, "areal density x area, but {mass}");
    }

    #[test]
    fn faces_look_towards_right_cross_up() {
        let (particles, topology) = ClothBuilder::new(1.0, 1.0, 5, 5).build_parts().expect("valid");
        for face in topology.faces() {
            let [p, q, r] = face.map(|i| particles.position(i as usize));
            assert!((q - p).cross(r - p).z > 0.0);
        }
    }

    #[test]
    fn pins_by_index_edge_and_predicate() {
        let pinned = |cloth: ClothBuilder| -> Vec<usize> {
            let (particles, _) = cloth.build_parts().expect("valid");
            (0..particles.len()).filter(|&i| particles.is_pinned(i)).collect()
        };
        let cloth = || ClothBuilder::new(1.0, 1.0, 3, 3);
        assert_eq!(pinned(cloth().pin(4)), [4]);
        assert_eq!(pinned(cloth().pin_edge(Edge::Top)), [0, 1, 2]);
        assert_eq!(pinned(cloth().pin_edge(Edge::Bottom)), [6, 7, 8]);
        assert_eq!(pinned(cloth().pin_edge(Edge::Left)), [0, 3, 6]);
        assert_eq!(pinned(cloth().pin_edge(Edge::Right)), [2, 5, 8]);
        assert_eq!(pinned(cloth().pin_where(|_, _, p| p.x > 0.4 && p.y < -0.6)), [7, 8]);
    }

    #[test]
    fn what_cannot_be_built_is_refused_by_name() {
        let density = |areal_density| ClothMaterial { areal_density, ..ClothMaterial::default() };
        let friction = |friction| ClothMaterial {
            bending_friction: BendingFriction::isotropic(friction),
            ..ClothMaterial::default()
        };
        let rigidity = |rigidity| ClothMaterial {
            bending_rigidity: BendingRigidity::isotropic(rigidity),
            ..ClothMaterial::default()
        };
        let cases = [
            (ClothBuilder::new(0.0, 1.0, 4, 4), "width"),
            (ClothBuilder::new(1.0, -1.0, 4, 4), "height"),
            (ClothBuilder::new(f32::NAN, 1.0, 4, 4), "width"),
            (ClothBuilder::new(f32::INFINITY, 1.0, 4, 4), "width"),
            (ClothBuilder::new(1.0, 1.0, 1, 1), "at least 2"),
            (ClothBuilder::new(1.0, 1.0, 0, 4), "at least 2"),
            (ClothBuilder::new(1.0, 1.0, u32::MAX, u32::MAX), "too many"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).pin(16), "a pin names particle 16"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).placed(Vec3::NAN, Vec3::X, Vec3::Y), "origin"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).placed(Vec3::ZERO, Vec3::X, Vec3::X), "axes"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(density(0.0)), "areal_density"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(density(f32::NAN)), "areal_density"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(rigidity(-1e-5)), "bending_rigidity"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(rigidity(f32::NAN)), "bending_rigidity"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(rigidity(1e5)), "bending_rigidity"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(friction(-1e-5)), "bending_friction"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(friction(f32::NAN)), "bending_friction"),
            (ClothBuilder::new(1.0, 1.0, 4, 4).material(friction(1e7)), "bending_friction"),
        ];
        for (cloth, needle) in cases {
            let message = cloth.build_parts().expect_err(needle).to_string();
            assert!(message.contains(needle), "{message}");
        }
    }
}
