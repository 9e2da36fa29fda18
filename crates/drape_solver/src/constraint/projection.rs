//! Formulas for the error of a stick: with a square root, or without; on both sides of its rest length, or on one.
//!
//! Each formula stands three times, for one stick, eight and sixteen; the kernels of sticks and tethers call them.
//!
//! Design: `docs/design/relaxation.md`.

use fearless_simd::{Simd, f32x8, f32x16, prelude::*};

use crate::state::topology::StickBound;

/// A formula for the relative error `(|delta| - rest) / |delta|`, for one stick, for eight, and for a cell.
pub(crate) trait Projection: Copy {
    /// The relative error of a stick with this squared length and rest length.
    fn error(self, length_squared: f32, rest: f32) -> f32;
    /// The same in lanes.
    fn errors<S: Simd>(self, simd: S, length_squared: f32x16<S>, rest: f32x16<S>) -> f32x16<S>;
    /// The same for eight sticks.
    fn errors_of_eight<S: Simd>(self, simd: S, length_squared: f32x8<S>, rest: f32x8<S>) -> f32x8<S>;
}

/// The exact error, by a square root. A stick of zero length has no direction, so its error counts as zero.
#[derive(Clone, Copy)]
pub(crate) struct Exact;

impl Projection for Exact {
    #[inline(always)]
    fn error(self, length_squared: f32, rest: f32) -> f32 {
        let length = length_squared.sqrt();
        if length > 0.0 { (length - rest) / length } else { 0.0 }
    }

    #[inline(always)]
    fn errors<S: Simd>(self, simd: S, length_squared: f32x16<S>, rest: f32x16<S>) -> f32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let length = length_squared.sqrt();
        length.simd_gt(zero).select((length - rest) / length, zero)
    }

    #[inline(always)]
    fn errors_of_eight<S: Simd>(self, simd: S, length_squared: f32x8<S>, rest: f32x8<S>) -> f32x8<S> {
        let zero = f32x8::splat(simd, 0.0);
        let length = length_squared.sqrt();
        length.simd_gt(zero).select((length - rest) / length, zero)
    }
}

/// The same to second order in the strain, without a square root.
#[derive(Clone, Copy)]
pub(crate) struct SquareRootFree;

impl Projection for SquareRootFree {
    #[inline(always)]
    fn error(self, length_squared: f32, rest: f32) -> f32 {
        let rest_squared = rest * rest;
        (length_squared - rest_squared) / (length_squared + rest_squared)
    }

    #[inline(always)]
    fn errors<S: Simd>(self, _: S, length_squared: f32x16<S>, rest: f32x16<S>) -> f32x16<S> {
        let rest_squared = rest * rest;
        (length_squared - rest_squared) / (length_squared + rest_squared)
    }

    #[inline(always)]
    fn errors_of_eight<S: Simd>(self, _: S, length_squared: f32x8<S>, rest: f32x8<S>) -> f32x8<S> {
        let rest_squared = rest * rest;
        (length_squared - rest_squared) / (length_squared + rest_squared)
    }
}

/// Any formula, for sticks that act on one side of their rest length only: errors on the other side are zero.
#[derive(Clone, Copy)]
pub(crate) struct OneSided<P> {
    projection: P,
    /// 1 for sticks that act if they are too long, -1 if too short.
    side: f32,
}

impl<P> OneSided<P> {
    /// The formula for sticks of this bound; none for those that act on both sides.
    pub fn of(bound: StickBound, projection: P) -> Option<Self> {
        match bound {
            StickBound::Exact => None,
            StickBound::AtLeast => Some(Self { projection, side: -1.0 }),
            StickBound::AtMost => Some(Self { projection, side: 1.0 }),
        }
    }
}

impl<P: Projection> Projection for OneSided<P> {
    #[inline(always)]
    fn error(self, length_squared: f32, rest: f32) -> f32 {
        let error = self.projection.error(length_squared, rest);
        if error * self.side > 0.0 { error } else { 0.0 }
    }

    #[inline(always)]
    fn errors<S: Simd>(self, simd: S, length_squared: f32x16<S>, rest: f32x16<S>) -> f32x16<S> {
        let error = self.projection.errors(simd, length_squared, rest);
        let zero = f32x16::splat(simd, 0.0);
        (error * self.side).simd_gt(zero).select(error, zero)
    }

    #[inline(always)]
    fn errors_of_eight<S: Simd>(self, simd: S, length_squared: f32x8<S>, rest: f32x8<S>) -> f32x8<S> {
        let error = self.projection.errors_of_eight(simd, length_squared, rest);
        let zero = f32x8::splat(simd, 0.0);
        (error * self.side).simd_gt(zero).select(error, zero)
    }
}
