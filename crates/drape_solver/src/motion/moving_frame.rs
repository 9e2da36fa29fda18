//! A frame of reference that moves: what a cloth does not inherit of the motion of its wearer.
//!
//! A cape on a character that runs, jumps and turns feels all of that, and flies like a flag. To calm it, a share of the
//! character's motion is taken for that of the frame in which the cape moves: it is carried along, and its velocity is
//! what it does besides. Obstacles and pins are where they are in the world, so that contacts and friction are worked out
//! there: a substep begins by carrying the particles along, with the velocity that this is, and ends by taking that velocity off.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::{Mat3, Vec3};

use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::lanes::{Lanes3, load};
use crate::state::frame_motion::SubstepMotion;

impl SubstepMotion {
    /// Carries free particles along, at the start of a substep, after their flight.
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
        let way = FrameLanes::new(simd, self, substep);
        for (place, cell) in places.zip(cells) {
            let position = Lanes3::load(simd, &moving.position[place]);
            let moved = way.of(position).or(way.is_free(simd, rest, cell), way.none);
            let position = position.plus(moved);
            position.store(&mut moving.position[place]);
            position.store(&mut moving.integrated[place]);
            Lanes3::load(simd, &moving.displacement[place])
                .plus(moved)
                .store(&mut moving.displacement[place]);
        }
    }

    /// Takes the motion of the frame off their displacements, at the end of the substep.
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
        let way = FrameLanes::new(simd, self, substep);
        for (place, cell) in places.zip(cells) {
            let displacement = Lanes3::load(simd, &moving.displacement[place]);
            let before = Lanes3::load(simd, &moving.position[place]).minus(displacement);
            let moved = way.of(before).or(way.is_free(simd, rest, cell), way.none);
            displacement.minus(moved).store(&mut moving.displacement[place]);
        }
    }
}

/// The same in lanes, for one substep.
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

    #[inline(always)]
    fn of(&self, position: Lanes3<S>) -> Lanes3<S> {
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
