//! A moving frame of reference carries particles along: they do not feel that part of their wearer's motion.
//!
//! Obstacles and pins stay where they are in the world, so contacts and friction are computed there. A substep begins
//! by moving the particles with the frame, which adds its velocity, and ends by subtracting that velocity.
//! `state/frame_motion.rs` says what a frame is for.
//!
//! Design: `docs/design/characters.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::{Mat3, Vec3};

use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::lanes::{Lanes3, load};
use crate::state::frame_motion::SubstepMotion;

impl SubstepMotion {
    /// Moves free particles with the frame, at the start of a substep, after their integration.
    #[inline(always)]
    pub fn carry<S: Simd>(
        &self,
        simd: S,
        moving: &mut MovingColumns,
        places: Range<usize>,
        rest: &BodyColumns,
        cells: Range<usize>,
        substep: u32,
    ) {
        let frame = FrameLanes::new(simd, self, substep);
        for (place, cell) in places.zip(cells) {
            let position = Lanes3::load(simd, &moving.position[place]);
            let moved = frame.travel(position).or(frame.is_free(simd, rest, cell), frame.none);
            let position = position.plus(moved);
            position.store(&mut moving.position[place]);
            position.store(&mut moving.integrated[place]);
            Lanes3::load(simd, &moving.displacement[place])
                .plus(moved)
                .store(&mut moving.displacement[place]);
        }
    }

    /// Subtracts the motion of the frame from their displacements, at the end of the substep.
    #[inline(always)]
    pub fn leave<S: Simd>(
        &self,
        simd: S,
        moving: &mut MovingColumns,
        places: Range<usize>,
        rest: &BodyColumns,
        cells: Range<usize>,
        substep: u32,
    ) {
        let frame = FrameLanes::new(simd, self, substep);
        for (place, cell) in places.zip(cells) {
            let displacement = Lanes3::load(simd, &moving.displacement[place]);
            let before = Lanes3::load(simd, &moving.position[place]).minus(displacement);
            let moved = frame.travel(before).or(frame.is_free(simd, rest, cell), frame.none);
            displacement.minus(moved).store(&mut moving.displacement[place]);
        }
    }
}

/// The motion of one substep, in lanes.
struct FrameLanes<S: Simd> {
    axes: [Lanes3<S>; 3],
    pivot: Lanes3<S>,
    translation: Lanes3<S>,
    none: Lanes3<S>,
}

impl<S: Simd> FrameLanes<S> {
    #[inline(always)]
    fn new(simd: S, motion: &SubstepMotion, substep: u32) -> Self {
        let Mat3 { x_axis, y_axis, z_axis } = motion.added;
        Self {
            axes: [Lanes3::splat(simd, x_axis), Lanes3::splat(simd, y_axis), Lanes3::splat(simd, z_axis)],
            pivot: Lanes3::splat(simd, motion.pivot + motion.translation * substep as f32),
            translation: Lanes3::splat(simd, motion.translation),
            none: Lanes3::splat(simd, Vec3::ZERO),
        }
    }

    /// Displacement of a point at `position` by the frame in the substep.
    #[inline(always)]
    fn travel(&self, position: Lanes3<S>) -> Lanes3<S> {
        let offset = position.minus(self.pivot);
        let [x, y, z] = self.axes;
        let turned = x.times(offset.x).plus(y.times(offset.y)).plus(z.times(offset.z));
        turned.plus(self.translation)
    }

    #[inline(always)]
    fn is_free(&self, simd: S, rest: &BodyColumns, cell: usize) -> mask32x16<S> {
        load(simd, &rest.inverse_mass[cell]).simd_gt(f32x16::splat(simd, 0.0))
    }
}
