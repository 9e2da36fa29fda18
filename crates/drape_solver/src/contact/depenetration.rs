//! Depenetration: takes out overlaps that no motion made, such as that of an obstacle which appears inside a cloth.
//!
//! A projection moves a particle and so changes its velocity, which is right for penetration that the motion of the
//! substep made. An initial overlap, which was there before the substep, has no velocity to stop: the same projection
//! would shoot the particle off at `depth / substep`. That part is moved in position only, spread over the rest of the
//! step, or over a reference step if that is longer, so that sticks can follow.
//!
//! ```text
//!   ===|============ surface
//!      |  initial overlap                  position_only: moved without a velocity
//!      o  start of the substep
//!      |  penetration that motion made     with_velocity: an ordinary contact
//!      o  end of the substep
//! ```
//!
//! Design: `docs/design/contacts.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::constants::{GENTLE_PUSH_OUT_SPEED, PUSH_OUT_SPEED, REFERENCE_STEP};
use crate::state::substep::Substep;

/// The overlap of one contact in one substep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InitialOverlap {
    /// Metres of the overlap that may be left at the end of the substep; known after the first projection.
    left: Option<f32>,
}

/// The distances by which one projection moves two things apart, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Correction {
    /// With a velocity: the part that the substep's motion made.
    pub with_velocity: f32,
    /// In position only: a part of the initial overlap.
    pub position_only: f32,
}

/// The rate at which initial overlaps are taken out.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PushOutRate {
    /// The fraction of an initial overlap that this substep takes out.
    share: f32,
    /// Metres that a substep takes out at least.
    least: f32,
    /// Length of a substep in seconds.
    substep: f32,
}

impl PushOutRate {
    /// For the substep that runs now.
    pub fn of(substep: Substep) -> Self {
        Self::new(substep.duration, substep.count, substep.index)
    }

    /// For substep `index` of `substeps`, of `substep` seconds.
    pub fn new(substep: f32, substeps: u32, index: u32) -> Self {
        let left = substeps.saturating_sub(index).max(1) as f32;
        // A hair less than a reference step, so that 1/60 s counts as one however it was rounded.
        let short = substep * (substeps as f32) < 0.999 * REFERENCE_STEP;
        let spread = if short { left.max(REFERENCE_STEP / substep) } else { left };
        Self { share: 1.0 / spread, least: PUSH_OUT_SPEED * substep, substep }
    }

    /// For contacts whose point wanders over a face. The overlap that one point finds where another has been is noise,
    /// and taking it out quickly would shake the cloth.
    pub fn gentle(substep: f32) -> Self {
        Self { share: 0.0, least: GENTLE_PUSH_OUT_SPEED * substep, substep }
    }
}

impl PushOutRate {
    /// Length of a substep in seconds.
    pub fn substep(self) -> f32 {
        self.substep
    }

    /// Metres of `initial` overlaps that may be left at the end of the substep, for the particles of a cell.
    #[inline(always)]
    pub fn left_in_lanes<S: Simd>(self, simd: S, initial: f32x16<S>) -> f32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let even = initial - initial * self.share;
        let quick = initial - self.least;
        let left = quick.simd_lt(even).select(quick, even);
        left.simd_gt(zero).select(left, zero)
    }
}

impl InitialOverlap {
    /// With the metres that may be left at the end of the substep, if they are known.
    pub fn with_left(left: Option<f32>) -> Self {
        Self { left }
    }

    /// Metres that may be left at the end of the substep, once they are known.
    pub fn left(self) -> Option<f32> {
        self.left
    }

    /// Splits a `depth` above zero. `outward` is the distance that the two have moved apart along the normal in this
    /// substep so far (metres; negative if they approached). `at_start` computes their overlap at the start of the
    /// substep; it is called only if the tangent plane does not rule one out.
    pub fn split(
        &mut self,
        depth: f32,
        outward: f32,
        at_start: impl FnOnce() -> f32,
        rate: PushOutRate,
    ) -> Correction {
        let initial = if depth + outward > 0.0 { at_start().max(0.0).min(depth) } else { 0.0 };
        let left = *self.left.get_or_insert_with(|| {
            let even = initial - initial * rate.share;
            even.min(initial - rate.least).max(0.0)
        });
        Correction { with_velocity: depth - initial, position_only: (initial - left).max(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_that_the_motion_made_is_a_contact_and_the_rest_is_not() {
        let rate = PushOutRate { share: 1.0, least: 0.0, substep: 0.01 };
        let split = |depth: f32, outward: f32| {
            InitialOverlap::default().split(depth, outward, || depth + outward, rate)
        };
        assert_eq!(split(0.25, -0.5), Correction { with_velocity: 0.25, position_only: 0.0 });
        assert_eq!(split(0.75, -0.25), Correction { with_velocity: 0.25, position_only: 0.5 });
        assert_eq!(split(0.25, 0.0), Correction { with_velocity: 0.0, position_only: 0.25 });
        assert_eq!(split(0.25, 0.5), Correction { with_velocity: 0.0, position_only: 0.25 });
    }

    #[test]
    fn what_came_round_a_curve_was_not_inside_before() {
        let rate = PushOutRate { share: 1.0, least: 0.0, substep: 0.01 };
        let push = InitialOverlap::default().split(0.25, 0.1, || -0.5, rate);
        assert_eq!(push, Correction { with_velocity: 0.25, position_only: 0.0 });
    }

    #[test]
    fn an_initial_overlap_is_taken_out_evenly_and_whole_within_the_step() {
        let mut depth = 1.0;
        for substeps_left in (1..=4).rev() {
            let rate = PushOutRate { share: 1.0 / substeps_left as f32, least: 0.01, substep: 0.01 };
            let mut overlap = InitialOverlap::default();
            depth -= overlap.split(depth, 0.0, || depth, rate).position_only;
            assert!((depth - 0.25 * (substeps_left - 1) as f32).abs() < 1e-6);
            let again = overlap.split(depth.max(1e-3), 0.0, || depth.max(1e-3), rate);
            assert!(again.position_only < 2e-3, "the second projection adds nothing");
        }
    }
}
