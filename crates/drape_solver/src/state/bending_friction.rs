//! Friction of bends: what holds a curvature until it slips, and the state that it keeps.
//!
//! ```text
//!      +---- c ------------------+
//!   o--+                         +--o      energy  (K - rest)^2 / (2 c) + 4 (K - plastic)^2 / (2 c)
//!      +-- c / 4 ---[ slips ]----+
//! ```
//!
//! The two elements of a bend act as one, of a fifth of the compliance `c`, with a rest between theirs (the element of Jenkins and
//! Prandtl). The plastic sum follows the weighted sum `K` at a distance.
//!
//! Design: `docs/design/bending.md`.

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;

use crate::error::{BuildError, in_range};
use crate::simd::columns::LANES;
use crate::state::layout::Layout;

/// Friction between the fibres of a surface that bends, in N: the moment, in N m for each metre of width, up to which it holds a
/// curvature. Zero holds nothing.
///
/// Textile laboratories measure it along the warp and the weft: it is half of the hysteresis 2HB of the KES system, whose
/// "gf cm/cm" is 9.8e-3 N. Fabrics for clothes have 5e-5 to 1e-3 N. Friction acts beside a
/// [`BendingRigidity`](crate::BendingRigidity), and without one not at all: it gives a cloth body, and a fold that is let go keeps a
/// curvature of up to friction over rigidity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BendingFriction {
    /// Of the threads that run down the columns of a grid. A mesh takes the mean of the two.
    pub warp: f32,
    /// Of the threads that run along the rows of a grid.
    pub weft: f32,
}

/// The greatest friction, in N.
const MOST: f32 = 1e6;

impl BendingFriction {
    /// The same friction in all directions, in N.
    pub const fn isotropic(friction: f32) -> Self {
        Self { warp: friction, weft: friction }
    }

    pub(crate) fn validate(self) -> Result<(), BuildError> {
        in_range("bending_friction", self.warp, 0.0, MOST)?;
        in_range("bending_friction", self.weft, 0.0, MOST)?;
        Ok(())
    }
}

/// By so many times the rigidity friction resists a change of curvature, until it slips.
const STIFFNESS: f32 = 4.0;

/// The slip of a bend with friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slip {
    /// Greatest distance in metres between the weighted sum and the plastic one.
    pub reach: f32,
}

impl Slip {
    /// The part of the plastic sum in the rest of both elements.
    pub const PLASTIC_PART: f32 = STIFFNESS / (1.0 + STIFFNESS);

    /// That of a bend with this `rigidity` in N m and `friction` in N, whose weighted sum is `scale` square metres times the curvature.
    /// None without friction.
    pub fn new(rigidity: f32, friction: f32, scale: f32) -> Option<Self> {
        let reach = friction / (STIFFNESS * rigidity) * scale;
        (reach > 0.0).then_some(Self { reach })
    }

    /// The compliance of both elements.
    pub fn compliance(slip: Option<Self>, alone: f32) -> f32 {
        if slip.is_some() { alone / (1.0 + STIFFNESS) } else { alone }
    }

    /// The plastic sum with which both elements are at rest at `sum`, or nearly, if friction cannot hold that much.
    pub fn balanced(self, rest: f32, sum: f32) -> f32 {
        self.follow(sum + (sum - rest) / STIFFNESS, sum)
    }

    /// The plastic sum once the weighted sum is `sum`.
    pub fn follow(self, plastic: f32, sum: f32) -> f32 {
        plastic.max(sum - self.reach).min(sum + self.reach)
    }
}

/// The plastic sums of a body's bends, in metres: state that outlives a step. Empty without friction.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PlasticBends {
    /// Of the threads of a grid, by the slot of the middle particle: along rows, and along columns.
    pub threads: [Vec<f32>; 2],
    /// Of the listed bends of a mesh.
    pub edges: Vec<f32>,
}

impl PlasticBends {
    /// Makes room for the threads of a grid, straight at first.
    pub fn reserve_threads(&mut self, layout: &Layout) {
        for threads in &mut self.threads {
            if threads.len() != layout.cells() * LANES {
                threads.clear();
                threads.resize(layout.cells() * LANES, 0.0);
            }
        }
    }

    /// Those of the threads in another layout, for pairs of old and new slots.
    pub fn picked(&self, layout: &Layout, slots: impl Iterator<Item = [usize; 2]>) -> Self {
        let mut picked = Self::default();
        if !self.threads[0].is_empty() {
            picked.reserve_threads(layout);
            for [from, to] in slots {
                for (picked, threads) in picked.threads.iter_mut().zip(&self.threads) {
                    picked[to] = threads[from];
                }
            }
        }
        picked
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let [rows, columns] = &self.threads;
        size_of_val(&**rows) + size_of_val(&**columns) + size_of_val(&*self.edges)
    }
}
