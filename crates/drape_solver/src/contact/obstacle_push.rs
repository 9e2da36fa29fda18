//! A push that an obstacle has given to a body or ball, for the account of its reaction.

use glam::{DVec3, Vec3};

use crate::simd::columns::Cell;

/// A push on a body or ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObstaclePush {
    pub obstacle: usize,
    /// In the world.
    pub point: DVec3,
    /// Mass times displacement, in kilogram metres.
    pub push: Vec3,
    /// Its moment about that point, in kg m^2.
    pub moment: Vec3,
}

impl ObstaclePush {
    /// A push in the middle of a point: no moment comes with it.
    pub fn at(point: DVec3, obstacle: usize, push: Vec3) -> Self {
        Self { obstacle, point, push, moment: Vec3::ZERO }
    }
}

/// Adds to a lane-wise sum what has been given to those lanes.
#[inline(always)]
pub(crate) fn add_to(sum: &mut Cell, before: &Cell, after: &Cell) {
    for (sum, (before, after)) in sum.axes_mut().into_iter().zip(before.axes().into_iter().zip(after.axes()))
    {
        for lane in 0..sum.len() {
            sum[lane] += after[lane] - before[lane];
        }
    }
}
