//! Boxes around things that move, each with the range of their motion.
//!
//! Two things come near each other only if the gap between their boxes is no wider than one may close on the other,
//! along each axis. So what flies together does not meet, however fast it flies.
//!
//! ```text
//!    +---+ ------>        gap g, approach at most fast_a - slow_b: they may meet if g <= that
//!    | a |    g   +---+
//!    +---+ <----> | b | -->
//!                 +---+
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3A;

use crate::geometry::nearest_lanes::{least, most};
use crate::simd::columns::LANES;
use crate::simd::lanes::{load, set_lanes};

/// A box around some points at the start, in metres, and around their ways.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptBox {
    pub low: Vec3A,
    pub high: Vec3A,
    pub slow: Vec3A,
    pub fast: Vec3A,
}

impl SweptBox {
    pub const NOTHING: Self = Self {
        low: Vec3A::INFINITY,
        high: Vec3A::NEG_INFINITY,
        slow: Vec3A::INFINITY,
        fast: Vec3A::NEG_INFINITY,
    };

    pub fn and(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            slow: self.slow.min(other.slow),
            fast: self.fast.max(other.fast),
        }
    }

    /// Widens the box to hold a point and its way.
    #[inline(always)]
    pub fn add(&mut self, start: Vec3A, way: Vec3A) {
        *self = self.and(&Self { low: start, high: start, slow: way, fast: way });
    }

    /// True if the two may touch on their way.
    pub fn meets(&self, other: &Self) -> bool {
        let towards = (other.fast - self.slow).max(Vec3A::ZERO);
        let back = (self.fast - other.slow).max(Vec3A::ZERO);
        ((self.low - other.high).cmple(towards) & (other.low - self.high).cmple(back)).all()
    }
}

/// The boxes of sixteen things.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct SweptBoxes {
    pub low: [[f32; LANES]; 3],
    pub high: [[f32; LANES]; 3],
    pub slow: [[f32; LANES]; 3],
    pub fast: [[f32; LANES]; 3],
}

impl SweptBoxes {
    pub const NOTHING: Self = Self {
        low: [[f32::INFINITY; LANES]; 3],
        high: [[f32::NEG_INFINITY; LANES]; 3],
        slow: [[f32::INFINITY; LANES]; 3],
        fast: [[f32::NEG_INFINITY; LANES]; 3],
    };

    /// Widens each box to hold another.
    #[inline(always)]
    pub fn add<S: Simd>(&mut self, simd: S, other: &Self) {
        for axis in 0..3 {
            let least_of = |own: &[f32; LANES], other| least(load(simd, own), load(simd, other)).to_array();
            let most_of = |own: &[f32; LANES], other| most(load(simd, own), load(simd, other)).to_array();
            self.low[axis] = least_of(&self.low[axis], &other.low[axis]);
            self.high[axis] = most_of(&self.high[axis], &other.high[axis]);
            self.slow[axis] = least_of(&self.slow[axis], &other.slow[axis]);
            self.fast[axis] = most_of(&self.fast[axis], &other.fast[axis]);
        }
    }

    pub fn at(&self, lane: usize) -> SweptBox {
        let of = |axes: &[[f32; LANES]; 3]| Vec3A::new(axes[0][lane], axes[1][lane], axes[2][lane]);
        SweptBox { low: of(&self.low), high: of(&self.high), slow: of(&self.slow), fast: of(&self.fast) }
    }

    /// The box around those in these lanes.
    pub fn of(&self, lanes: u16) -> SweptBox {
        set_lanes(lanes).fold(SweptBox::NOTHING, |all, lane| all.and(&self.at(lane)))
    }

    /// Bit mask of the things that may touch another on their way.
    #[inline(always)]
    pub fn meets<S: Simd>(&self, simd: S, other: &SweptBox) -> u16 {
        let mut all = u16::MAX;
        for axis in 0..3 {
            let SweptBox { low, high, slow, fast } = other;
            all &= self.meets_along(simd, axis, [low[axis], high[axis], slow[axis], fast[axis]]);
        }
        all
    }

    /// The same for the thing in this `lane` of others.
    #[inline(always)]
    pub fn meets_lane<S: Simd>(&self, simd: S, other: &Self, lane: usize) -> u16 {
        let mut all = u16::MAX;
        for axis in 0..3 {
            let Self { low, high, slow, fast } = other;
            let other = [low[axis][lane], high[axis][lane], slow[axis][lane], fast[axis][lane]];
            all &= self.meets_along(simd, axis, other);
        }
        all
    }

    /// The same along one axis: another's least and greatest place and way.
    #[inline(always)]
    fn meets_along<S: Simd>(&self, simd: S, axis: usize, [low, high, slow, fast]: [f32; 4]) -> u16 {
        let zero = f32x16::splat(simd, 0.0);
        let towards = most(load(simd, &self.fast[axis]) - f32x16::splat(simd, slow), zero);
        let back = most(f32x16::splat(simd, fast) - load(simd, &self.slow[axis]), zero);
        let before = f32x16::splat(simd, low) - load(simd, &self.high[axis]);
        let behind = load(simd, &self.low[axis]) - f32x16::splat(simd, high);
        (before.simd_le(towards) & behind.simd_le(back)).to_bitmask() as u16
    }

    /// Bit mask of the things whose boxes overlap that in this `lane` of others before anything moves, if the two are `less`
    /// metres smaller together.
    #[inline(always)]
    pub fn overlaps_lane<S: Simd>(&self, simd: S, other: &Self, lane: usize, less: f32) -> u16 {
        let less = f32x16::splat(simd, less);
        let mut all = u16::MAX;
        for axis in 0..3 {
            let low = f32x16::splat(simd, other.low[axis][lane]);
            let high = f32x16::splat(simd, other.high[axis][lane]);
            let is_before = (low + less).simd_le(load(simd, &self.high[axis]));
            let is_behind = (load(simd, &self.low[axis]) + less).simd_le(high);
            all &= (is_before & is_behind).to_bitmask() as u16;
        }
        all
    }
}
