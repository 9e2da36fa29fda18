//! Limits on motion: each particle stays within a distance of its animated place.
//!
//! ```text
//!        . - .
//!      .   c---x    c  the animated place of the particle
//!        . - .      x  the particle: put back onto the ball if it is farther away
//! ```
//!
//! Limits act last in each substep, after contacts and friction. They also change velocities, so that a particle that
//! is held back does not swing on. Between two steps a centre travels evenly over the substeps, as a pin does.
//!
//! Design: `docs/design/characters.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::columns::LANES;
use crate::simd::lanes::{Lanes3, load};
use crate::state::motion_limits::MotionLimits;

impl MotionLimits {
    /// Puts the free particles of `cells`, at `places` in the moving columns, back within their limits at this
    /// `fraction` of the step.
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
        for (place, cell) in places.zip(cells) {
            let Ball { centre, reach } = self.balls(simd, cell, fraction);
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

    /// The balls that the particles of a cell may not leave, at this fraction of the step.
    #[inline(always)]
    pub fn balls<S: Simd>(&self, simd: S, cell: usize, fraction: f32) -> Ball<S> {
        let centre = self.centre.at(simd, cell, fraction);
        Ball { centre, reach: load(simd, &self.reach.as_chunks::<LANES>().0[cell]) }
    }
}

/// A ball that a limit allows, in each lane.
pub(crate) struct Ball<S: Simd> {
    pub centre: Lanes3<S>,
    /// Metres; infinite without a limit.
    pub reach: f32x16<S>,
}
