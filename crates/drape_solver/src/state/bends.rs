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

use glam::Vec3;

use crate::error::{BuildError, in_range};
use crate::simd::columns::Cell;
use crate::simd::rows::{ALL_BLOCKS, Rows};
use crate::state::bending_friction::{BendingFriction, PlasticBends, Slip};

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
    pub friction: BendingFriction,
    /// Those of a whole grid: its rows and columns are solved directly.
    pub lines: Option<BentGrid>,
    /// Those of meshes and torn grids.
    pub listed: Vec<ListedBend>,
    /// The stiffness of all listed bends, as it joins particles.
    pub matrix: BendMatrix,
    /// True if listed bends have a rest that is not zero, or may get one by friction.
    pub have_rests: bool,
}

/// The bends of a whole grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BentGrid {
    pub columns: usize,
    pub rows: usize,
    /// The threads along rows and along columns. None where nothing resists.
    pub threads: [Option<BentThreads>; 2],
}

/// The bends of the threads in one direction of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BentThreads {
    /// In m/N, without friction, where they are as wide as lines are apart.
    pub compliance: f32,
    pub slip: Option<Slip>,
}

impl BentThreads {
    /// The compliance with friction, in m/N.
    pub fn compliance_of_both(self) -> f32 {
        Slip::compliance(self.slip, self.compliance)
    }
}

/// The stiffness of listed bends as a sparse matrix, row by row, without its diagonal: rows sum to zero, so that the forces follow from
/// differences.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BendMatrix {
    /// Index of the first entry of each slot; one more at the end.
    pub starts: Vec<u32>,
    pub entries: Vec<BendEntry>,
}

/// An entry of a [`BendMatrix`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BendEntry {
    /// Where the row of the other particle starts: four times its slot.
    pub row: u32,
    /// In N/m.
    pub stiffness: f32,
}

/// One bend in a list.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ListedBend {
    /// In a bend of three particles the last is a neighbour of the second across the thread, which shows where the front is; without
    /// one it is the third once more.
    pub slots: [u32; 4],
    /// They sum to zero; the last is zero in a bend of three particles.
    pub weights: [f32; 4],
    /// In N/m, with that of friction before it slips.
    pub stiffness: f32,
    /// Length of the weighted sum of the positions at rest, in metres: positive if the corners lie behind the edge, seen from
    /// the front, negative if before it.
    pub rest: f32,
    pub slip: Option<Slip>,
    /// The direction of the thread of a grid: 0 along a row, 1 along a column. None across the edge of a mesh.
    pub thread: Option<u8>,
}

/// Scratch of a solve. Only the memory of its rows, which are of the whole body, outlives the solve.
#[derive(Clone, Debug, Default)]
pub(crate) struct BendScratch {
    pub places: Rows,
    pub residual: Rows,
    pub pull: Rows,
    pub direction: Rows,
    pub image: Rows,
    /// The weighted sums at rest of threads that friction holds, along rows and along columns, by the slot of the middle particle.
    pub rest: [Vec<Cell>; 2],
    /// The weighted sums at rest of listed bends, filled up to a multiple of sixteen; empty if all are zero. The fourth number is zero.
    pub listed_rests: Vec<[f32; 4]>,
}

impl BendScratch {
    /// Makes room for this number of cells.
    pub fn reserve(&mut self, cells: usize) {
        let Self { places, residual, pull, direction, image, .. } = self;
        for rows in [places, residual, pull, direction, image] {
            rows.reset(ALL_BLOCKS, cells);
        }
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let rest = self.rest.iter().map(|rest| size_of_val(&**rest)).sum::<usize>();
        5 * self.places.bytes() + rest + size_of_val(&*self.listed_rests)
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

    /// The unit normal of the surface there; zero where it has none.
    pub fn normal(&self, [a, b, c, d]: [Vec3; 4]) -> Vec3 {
        let normal = match self.thread {
            Some(_) => (c - a).cross(d - b),
            None => (b - a).cross(c - a) - (b - a).cross(d - a),
        };
        normal.normalize_or_zero()
    }

    /// The weighted sum along the normal.
    pub fn signed_sum(&self, places: [Vec3; 4]) -> f32 {
        self.sum(places).dot(self.normal(places))
    }

    /// Its plastic sum; `index` is its place in the list.
    #[inline(always)]
    pub fn plastic(&self, index: usize, plastic: &PlasticBends) -> f32 {
        match self.thread {
            Some(direction) => plastic.threads[usize::from(direction)][self.slots[1] as usize],
            None => plastic.edges[index],
        }
    }

    /// Sets its plastic sum.
    #[inline(always)]
    pub fn set_plastic(&self, index: usize, plastic: &mut PlasticBends, sum: f32) {
        match self.thread {
            Some(direction) => plastic.threads[usize::from(direction)][self.slots[1] as usize] = sum,
            None => plastic.edges[index] = sum,
        }
    }
}

impl Bends {
    /// True if friction holds them.
    pub fn has_friction(&self) -> bool {
        !self.rigidity.is_zero() && self.friction != BendingFriction::default()
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let BendMatrix { starts, entries } = &self.matrix;
        size_of_val(&*self.listed) + size_of_val(&**starts) + size_of_val(&**entries)
    }
}
