//! Limits on motion: how far a particle may be from a place that an animation gives it.
//!
//! ```text
//!        . - .
//!      .   c---x    c  where the animation has the particle
//!        . - .      x  where it is: at most its distance away, put back onto the ball where it is farther
//! ```
//!
//! The last word of each substep, after contacts and friction. Velocities follow, so that what is held back does not swing on. Between
//! two steps a centre travels evenly over the substeps, as a pin does.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::columns::LANES;
use crate::simd::lanes::{Lanes3, load};
use crate::state::motion_limits::MotionLimits;

impl MotionLimits {
    /// Puts the free particles of `cells`, which are at `places` in the columns that move, back into their limits, as they are at
    /// this fraction of the step.
    #[inline(always)]
    pub fn enforce<S: Simd>(
        &self,
        simd: S,
        moving: &mut MovingColumns,
        places: Range<usize>,
        rest: &BodyColumns,
        cells: Range<usize>,
        fraction: f32,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        let fraction = f32x16::splat(simd, fraction);
        let (reaches, _) = self.reach.as_chunks::<LANES>();
        for (place, cell) in places.zip(cells) {
            let reach = load(simd, &reaches[cell]);
            let start = Lanes3::load(simd, &self.centre.cells[cell]);
            let end = Lanes3::load(simd, &self.target.cells[cell]);
            let centre = start.plus(end.minus(start).times(fraction));
            let position = Lanes3::load(simd, &moving.position[place]);
            let offset = position.minus(centre);
            let squared = offset.dot(offset);
            let is_free: mask32x16<S> = load(simd, &rest.inverse_mass[cell]).simd_gt(zero);
            let is_beyond = squared.simd_gt(reach * reach) & is_free;
            if !is_beyond.any_true() {
                continue;
            }
            let back = centre.plus(offset.times(reach / squared.sqrt()));
            let displacement = Lanes3::load(simd, &moving.displacement[place]);
            displacement
                .plus(back.minus(position))
                .or(is_beyond, displacement)
                .store(&mut moving.displacement[place]);
            back.or(is_beyond, position).store(&mut moving.position[place]);
        }
    }
}
