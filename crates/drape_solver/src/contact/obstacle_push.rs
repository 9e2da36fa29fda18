//! A push of an obstacle on a body or ball, whose opposite is the reaction on the obstacle.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::{DVec3, Vec3};

use crate::simd::columns::Cell;

/// A push on a body or ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObstaclePush {
    pub obstacle: usize,
    /// Point of action, in the world.
    pub point: DVec3,
    /// Mass times displacement, in kilogram metres.
    pub push: Vec3,
    /// Its moment about that point, in kg m^2.
    pub moment: Vec3,
}

impl ObstaclePush {
    /// A push at a point, without a moment.
    pub fn at(point: DVec3, obstacle: usize, push: Vec3) -> Self {
        Self { obstacle, point, push, moment: Vec3::ZERO }
    }
}

/// Adds the change from `before` to `after` to `sum`, lane by lane.
#[inline(always)]
pub(crate) fn add_to(sum: &mut Cell, before: &Cell, after: &Cell) {
    for (sum, (before, after)) in sum.axes_mut().into_iter().zip(before.axes().into_iter().zip(after.axes()))
    {
        for lane in 0..sum.len() {
            sum[lane] += after[lane] - before[lane];
        }
    }
}
