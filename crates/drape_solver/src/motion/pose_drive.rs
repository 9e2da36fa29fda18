//! Drives towards the animated pose: the exact motion of a damped spring between substeps of equal length.
//!
//! With `x` relative to the animated place and equal steps, a damped oscillator obeys
//!
//! ```text
//! x[n+1] - x[n] = decay (x[n] - x[n-1]) - pull x[n]
//! ```
//!
//! whose factors hold its frequency and damping for any step, so it is stable for any stiffness, and the displacement is
//! what it is everywhere here: the way of the last substep. Other accelerations count by the part `gain`, which leaves
//! the particle at rest where spring and load balance. In between two steps the place travels evenly.
//!
//! Design: `docs/design/characters.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::columns::LANES;
use crate::simd::lanes::{Lanes3, load};
use crate::state::pose_drives::PoseDrives;

impl PoseDrives {
    /// Draws the free particles of `cells`, at `places` in the moving columns, towards where the animation has them, in
    /// a substep that begins at this `fraction` of the step. They have flown freely by one substep.
    #[inline(always)]
    pub fn draw<S: Simd>(
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
        let part = f32x16::splat(simd, 1.0 / rest.substep.count as f32);
        let [decays, pulls, gains] = [&self.factors.decay, &self.factors.pull, &self.factors.gain]
            .map(|column| column.as_chunks::<LANES>().0);
        for (place, cell) in places.zip(cells) {
            let pull = load(simd, &pulls[cell]);
            let is_free: mask32x16<S> = load(simd, &rest.inverse_mass[cell]).simd_gt(zero);
            let is_driven = pull.simd_gt(zero) & is_free;
            if !is_driven.any_true() {
                continue;
            }
            let from = Lanes3::load(simd, &self.place.now.cells[cell]);
            let way = Lanes3::load(simd, &self.place.next.cells[cell]).minus(from);
            let travel = way.times(part);
            let position = Lanes3::load(simd, &moving.position[place]);
            let flown = Lanes3::load(simd, &moving.displacement[place]);
            let offset = position.minus(flown).minus(from.plus(way.times(fraction)));
            let accelerated = rest.flight.accelerated(simd, rest, cell);
            let relative = flown.minus(accelerated).minus(travel);
            let driven = relative
                .times(load(simd, &decays[cell]))
                .minus(offset.times(pull))
                .plus(accelerated.times(load(simd, &gains[cell])))
                .plus(travel)
                .or(is_driven, flown);
            let position = position.plus(driven.minus(flown));
            driven.store(&mut moving.displacement[place]);
            position.store(&mut moving.position[place]);
            position.store(&mut moving.integrated[place]);
        }
    }
}
