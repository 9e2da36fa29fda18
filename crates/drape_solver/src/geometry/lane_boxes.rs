//! Boxes in lanes.
//!
//! Design: `docs/design/kernels.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::geometry::nearest_lanes::{least, most};
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, of_two};

/// A box in each lane, at rest in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellBoxes {
    pub low: Cell,
    pub high: Cell,
}

impl CellBoxes {
    pub const NOTHING: Self = Self { low: all(f32::INFINITY), high: all(f32::NEG_INFINITY) };
}

const fn all(number: f32) -> Cell {
    Cell { x: [number; LANES], y: [number; LANES], z: [number; LANES] }
}

/// A box in each lane.
#[derive(Clone, Copy)]
pub(crate) struct LaneBoxes<S: Simd> {
    pub low: Lanes3<S>,
    pub high: Lanes3<S>,
}

impl<S: Simd> LaneBoxes<S> {
    #[inline(always)]
    pub fn nothing(simd: S) -> Self {
        Self { low: Lanes3::splat(simd, Vec3::INFINITY), high: Lanes3::splat(simd, Vec3::NEG_INFINITY) }
    }

    #[inline(always)]
    pub fn of(point: Lanes3<S>) -> Self {
        Self { low: point, high: point }
    }

    /// The boxes around an edge as it is and as it becomes, if it changes like this.
    #[inline(always)]
    pub fn of_edge(edge: Lanes3<S>, change: Lanes3<S>) -> Self {
        Self::of(edge).and(Self::of(edge.plus(change)))
    }

    #[inline(always)]
    pub fn load(simd: S, boxes: &CellBoxes) -> Self {
        Self { low: Lanes3::load(simd, &boxes.low), high: Lanes3::load(simd, &boxes.high) }
    }

    #[inline(always)]
    pub fn store(self, boxes: &mut CellBoxes) {
        self.low.store(&mut boxes.low);
        self.high.store(&mut boxes.high);
    }

    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        let (low, high) = (self.low, self.high);
        Self {
            low: Lanes3 {
                x: least(low.x, other.low.x),
                y: least(low.y, other.low.y),
                z: least(low.z, other.low.z),
            },
            high: Lanes3 {
                x: most(high.x, other.high.x),
                y: most(high.y, other.high.y),
                z: most(high.z, other.high.z),
            },
        }
    }

    /// The boxes, so many times as far from zero and as large.
    #[inline(always)]
    pub fn times(self, factor: f32x16<S>) -> Self {
        Self { low: self.low.times(factor), high: self.high.times(factor) }
    }

    /// These boxes where `mask` holds, else nothing.
    #[inline(always)]
    pub fn only(self, simd: S, mask: mask32x16<S>) -> Self {
        let nothing = Self::nothing(simd);
        Self { low: self.low.or(mask, nothing.low), high: self.high.or(mask, nothing.high) }
    }

    /// The boxes of the lanes that follow.
    #[inline(always)]
    pub fn next_lanes(self) -> Self {
        Self { low: self.low.shifted::<1>(), high: self.high.shifted::<1>() }
    }

    /// The box of this lane, in all lanes.
    #[inline(always)]
    pub fn splat_lane(self, simd: S, lane: usize) -> Self {
        let [low, high] = of_two(
            [self.low, self.high],
            #[inline(always)]
            |corner| {
                let [x, y, z] = [corner.x, corner.y, corner.z];
                let corner = Vec3::new(x.to_array()[lane], y.to_array()[lane], z.to_array()[lane]);
                Lanes3::splat(simd, corner)
            },
        );
        Self { low, high }
    }

    /// The box around those of all lanes.
    #[inline(always)]
    pub fn all_lanes(self) -> [Vec3; 2] {
        let least_of = |axis: f32x16<S>| axis.to_array().into_iter().fold(f32::INFINITY, f32::min);
        let most_of = |axis: f32x16<S>| axis.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
        let Self { low, high } = self;
        [
            Vec3::new(least_of(low.x), least_of(low.y), least_of(low.z)),
            Vec3::new(most_of(high.x), most_of(high.y), most_of(high.z)),
        ]
    }

    /// Greatest distances from zero along the axes.
    #[inline(always)]
    pub fn farthest(self) -> Lanes3<S> {
        let Self { low, high } = self;
        Lanes3 { x: most(-low.x, high.x), y: most(-low.y, high.y), z: most(-low.z, high.z) }
    }

    /// Squared distance from `centre`.
    #[inline(always)]
    pub fn distance_squared(self, simd: S, centre: Lanes3<S>) -> f32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let (above, below) = (self.low.minus(centre), centre.minus(self.high));
        let away = Lanes3 {
            x: most(most(above.x, below.x), zero),
            y: most(most(above.y, below.y), zero),
            z: most(most(above.z, below.z), zero),
        };
        away.dot(away)
    }
}
