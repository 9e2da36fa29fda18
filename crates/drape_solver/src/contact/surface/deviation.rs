//! The deviation of a body's particles from the ways that are watched.
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::geometry::lane_boxes::{CellBoxes, LaneBoxes};
use crate::geometry::nearest_lanes::most;
use crate::simd::isa::Kernel;

/// Bounds of how far a particle is off, and how far two are off against each other, in metres.
pub(crate) struct Deviation<'a>(pub &'a [CellBoxes]);

impl Kernel for Deviation<'_> {
    type Output = [f32; 2];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [f32; 2] {
        let mut farthest = f32x16::splat(simd, 0.0);
        let mut all = LaneBoxes::nothing(simd);
        for off in self.0 {
            let off = LaneBoxes::load(simd, off);
            let end = off.farthest();
            farthest = most(farthest, end.dot(end));
            all = all.and(off);
        }
        let [low, high] = all.all_lanes();
        [farthest.to_array().into_iter().fold(0.0, f32::max).sqrt(), (high - low).length()]
    }
}
