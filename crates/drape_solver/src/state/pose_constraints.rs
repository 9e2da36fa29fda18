//! All that ties a body's particles to an animated pose: limits on motion, backstops, drives.
//!
//! Design: `docs/design/characters.md`.

use glam::Vec3;

use crate::simd::columns::{Cell, LANES};
use crate::state::animated_columns::AnimatedColumns;
use crate::state::backstops::Backstops;
use crate::state::layout::Layout;
use crate::state::motion_limits::MotionLimits;
use crate::state::pose_drives::PoseDrives;

/// Limits, backstops and drives of a body's particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PoseConstraints {
    pub limits: MotionLimits,
    pub backstops: Backstops,
    pub drives: PoseDrives,
}

impl PoseConstraints {
    pub fn is_empty(&self) -> bool {
        self.limits.is_empty() && self.backstops.is_empty() && self.drives.is_empty()
    }

    /// The constraints of some slots in the slots of another body of `cells` cells, as pairs of (from, to).
    pub fn picked(&self, cells: usize, slots: impl Iterator<Item = (usize, usize)>) -> Self {
        let Self { limits, backstops, drives } = self;
        let mut picked = Self::default();
        if self.is_empty() {
            return picked;
        }
        let [has_limits, has_backstops, has_drives] =
            [limits.is_empty(), backstops.is_empty(), drives.is_empty()].map(|is_empty| !is_empty);
        if has_limits {
            picked.limits.reset(cells);
        }
        if has_backstops {
            picked.backstops.reset(cells);
        }
        if has_drives {
            picked.drives.reset(cells);
        }
        for (from, to) in slots {
            if let Some((centre, target, reach)) = limits.get(from) {
                picked.limits.set(to, centre, target, reach);
            }
            if has_backstops {
                picked.backstops.copy(to, backstops, from);
            }
            if has_drives {
                picked.drives.copy(to, drives, from);
            }
        }
        picked
    }

    /// The same in the slots of another layout.
    pub fn arranged(&self, from: &Layout, to: &Layout) -> Self {
        self.picked(to.cells(), from.slots().zip(to.slots()))
    }

    /// Ends a step: everything is where the animation had it at the end.
    pub fn arrive(&mut self) {
        self.limits.arrive();
        self.backstops.place.arrive();
        self.backstops.normal.arrive();
        self.drives.place.arrive();
    }

    pub fn is_finite(&self) -> bool {
        let Self { limits, backstops, drives } = self;
        let columns = [&backstops.place, &backstops.normal, &drives.place];
        limits.is_finite() && columns.into_iter().all(AnimatedColumns::is_finite)
    }

    /// Moves all places, which are relative to the body's origin.
    pub fn shift(&mut self, shift: Vec3) {
        let MotionLimits { centre, target, .. } = &mut self.limits;
        for axes in centre.cells.iter_mut().chain(&mut target.cells).map(Cell::axes_mut) {
            for (column, shift) in axes.into_iter().zip(shift.to_array()) {
                column.iter_mut().for_each(|x| *x += shift);
            }
        }
        self.backstops.place.change(|place| place + shift);
        self.drives.place.change(|place| place + shift);
    }

    /// Turns all places about the body's origin, and all normals.
    pub fn turn(&mut self, turn: impl Fn(Vec3) -> Vec3) {
        for column in [&mut self.limits.centre, &mut self.limits.target] {
            (0..column.cells.len() * LANES).for_each(|slot| column.set(slot, turn(column.get(slot))));
        }
        let Self { backstops, drives, .. } = self;
        for columns in [&mut backstops.place, &mut backstops.normal, &mut drives.place] {
            columns.change(&turn);
        }
    }

    /// Upper bound in metres on the way that limits and backstops move a particle at `position` in `slot`.
    pub fn pull(&self, slot: usize, position: Vec3) -> f32 {
        let limit = self.limits.get(slot).map(|(_, target, reach)| target.distance(position) - reach);
        let backstop = self.backstops.get(slot).map(|backstop| {
            let [now, next] = self.backstops.centres(slot);
            let depth = backstop.radius - now.distance(position).min(next.distance(position));
            depth.max(0.0) + now.distance(next)
        });
        limit.unwrap_or(0.0).max(0.0) + backstop.unwrap_or(0.0)
    }
}
