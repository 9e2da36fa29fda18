//! Resistance of a grid in its own plane, as a textile laboratory measures it.
//!
//! Design: `docs/design/membrane.md`.

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;

use glam::{DVec3, Vec3};

use crate::error::{BuildError, in_range};

/// Resistance of a cloth in its own plane, in newtons per metre of width. Where it is zero, a stiffness from 0 to 1 tells instead.
///
/// A shirting has some 5,000 N/m along warp and weft, a knit some 50, and both some 30 N/m in shear. The "gf/(cm degree)" of the
/// KES system is 56 N/m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MembraneStiffness {
    /// Tension per width and strain in a strip that is pulled along the columns, free to become narrower.
    pub warp: f32,
    /// The same along the rows.
    pub weft: f32,
    /// Shear force per width and radian.
    pub shear: f32,
}

/// The greatest stiffness, in N/m: that of a steel sheet of 5 mm.
const MOST: f32 = 1e9;

/// More columns and rows than a body has particles.
const MOST_PLACES: f64 = 1e8;

impl MembraneStiffness {
    /// The same tension in both directions, and this resistance to shear, in N/m.
    pub const fn balanced(tension: f32, shear: f32) -> Self {
        Self { warp: tension, weft: tension, shear }
    }

    pub(crate) fn validate(self) -> Result<(), BuildError> {
        for stiffness in [self.warp, self.weft, self.shear] {
            in_range("membrane_stiffness", stiffness, 0.0, MOST)?;
        }
        Ok(())
    }
}

/// Sticks of a grid that are springs: the rows, columns and diagonals that have some are solved directly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Membrane {
    /// The numbers of columns and rows; none in what a tear has left of a grid.
    pub size: Option<[usize; 2]>,
    /// The first particle of the whole grid at rest, and the ways to the next one in its row and in its column, in metres.
    pub frame: [DVec3; 3],
    /// Those along rows; none where a stiffness from 0 to 1 tells instead.
    pub rows: Option<ElasticStick>,
    pub columns: Option<ElasticStick>,
    pub diagonals: Option<ElasticStick>,
}

impl Membrane {
    /// The springs of a part of the grid.
    pub fn torn(self) -> Self {
        Self { size: None, ..self }
    }

    /// Column and row in the whole grid of a particle that is here at rest.
    pub fn place(&self, rest: Vec3) -> [isize; 2] {
        let [first, right, down] = self.frame;
        let along = |way: DVec3| (rest.as_dvec3() - first).dot(way) / way.length_squared();
        [right, down].map(|way| along(way).clamp(-MOST_PLACES, MOST_PLACES).round() as isize)
    }
}

/// Equal sticks along lines of a grid. At an edge of the cloth those along it are half as wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ElasticStick {
    /// Length at rest in metres.
    pub rest: f32,
    /// Compliance inside the cloth in m/N, or over the square of a substep in 1/kg. Zero is rigid.
    pub compliance: f32,
}
