//! Bends: places where a surface resists curvature.
//!
//! ```text
//!   along a row or a column        across an edge
//!                                       1
//!     a-----b-----c                   / | \
//!     1    -2     1                  2  |  3
//!                                     \ | /
//!                                       0
//! ```
//!
//! The weighted sum of the positions, `K`, is zero where the surface is flat, and grows with its curvature. A bend has the energy
//! `K^2 / (2 compliance)`: of the curvature of threads on grids, of the angle between triangles on meshes (Bergou, Wardetzky,
//! Harmon, Zorin and Grinspun 2006, "A Quadratic Bending Model for Inextensible Surfaces").
//!
//! Design: `docs/design/bending.md`.

use core::ops::{Add, Mul, Sub};

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;

use glam::Vec4;

use crate::error::{BuildError, in_range};

/// Resistance to bending in N m: the moment, in newtons for each metre of width, that bends a strip to a curvature of 1/m. Zero
/// resists nothing.
///
/// Textile laboratories measure it along the warp and the weft. A thin faille has 2e-6 N m, a shirting 1e-5, denim 2e-5, leather a
/// hundred times as much. The "gf cm^2/cm" of the KES system is 9.8e-5 N m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BendingRigidity {
    /// Of the threads that run down the columns of a grid. A mesh takes the mean of the two.
    pub warp: f32,
    /// Of the threads that run along the rows of a grid.
    pub weft: f32,
}

/// The greatest rigidity, in N m: that of a steel sheet of 8 mm.
const MOST: f32 = 1e4;

impl BendingRigidity {
    /// The same rigidity in all directions, in N m.
    pub const fn isotropic(rigidity: f32) -> Self {
        Self { warp: rigidity, weft: rigidity }
    }

    /// True if nothing resists.
    pub fn is_zero(self) -> bool {
        self == Self::default()
    }

    pub(crate) fn validate(self) -> Result<(), BuildError> {
        in_range("bending_rigidity", self.warp, 0.0, MOST)?;
        in_range("bending_rigidity", self.weft, 0.0, MOST)?;
        Ok(())
    }
}

/// The bends of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Bends {
    pub rigidity: BendingRigidity,
    /// Those of a whole grid: its rows and columns are solved directly.
    pub lines: Option<BentGrid>,
    /// Those of meshes and torn grids.
    pub listed: Vec<ListedBend>,
}

/// The bends of a whole grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BentGrid {
    pub columns: usize,
    pub rows: usize,
    /// Of the bends along rows and along columns, in m/N, where they are as wide as lines are apart. None where nothing resists.
    pub compliance: [Option<f32>; 2],
}

/// One bend in a list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ListedBend {
    /// The last two are equal in a bend of three particles.
    pub slots: [u32; 4],
    /// They sum to zero; the last is zero in a bend of three particles.
    pub weights: [f32; 4],
    /// In m/N.
    pub compliance: f32,
    /// Length of the weighted sum of the positions at rest, in metres: positive if the corners lie behind the edge, seen from
    /// the front, negative if before it.
    pub rest: f32,
}

/// Scratch of a solve, in slots. Only its memory outlives the solve. The fourth number of each is not used.
#[derive(Clone, Debug, Default)]
pub(crate) struct BendScratch {
    pub residual: Vec<Vec4>,
    /// The direction, times the masses.
    pub pull: Vec<Vec4>,
    pub direction: Vec<Vec4>,
    /// The matrix times the direction.
    pub image: Vec<Vec4>,
}

impl BendScratch {
    /// Makes room for this number of slots.
    pub fn reserve(&mut self, slots: usize) {
        for column in [&mut self.residual, &mut self.pull, &mut self.direction, &mut self.image] {
            column.resize(slots, Vec4::ZERO);
        }
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        4 * size_of_val(&*self.residual)
    }
}

/// True if a row or column of `count` is at an edge of the cloth, where bends are half as wide.
#[inline(always)]
pub(crate) fn is_at_edge(line: usize, count: usize) -> bool {
    line == 0 || line + 1 == count
}

impl ListedBend {
    /// The weighted sum of four places or ways. By differences, as places may be large and their weighted sum small.
    #[inline(always)]
    pub fn sum<V>(&self, [a, b, c, d]: [V; 4]) -> V
    where
        V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f32, Output = V>,
    {
        let [_, wb, wc, wd] = self.weights;
        (b - a) * wb + (c - a) * wc + (d - a) * wd
    }
}

impl Bends {
    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.listed)
    }
}
