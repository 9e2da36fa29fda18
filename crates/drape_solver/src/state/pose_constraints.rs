//! All that ties a body's particles to an animated pose: limits on motion, backstops, drives.
//!
//! Design: `docs/design/characters.md`.

use glam::Vec3;

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
        if !limits.is_empty() {
            picked.limits.reset(cells);
        }
        if !backstops.is_empty() {
            picked.backstops.reset(cells);
        }
        if !drives.is_empty() {
            picked.drives.reset(cells);
        }
        for (from, to) in slots.filter(|_| !self.is_empty()) {
            picked.limits.copy(to, limits, from);
            picked.backstops.copy(to, backstops, from);
            picked.drives.copy(to, drives, from);
        }
        picked
    }

    /// The same in the slots of another layout.
    pub fn arranged(&self, from: &Layout, to: &Layout) -> Self {
        self.picked(to.cells(), from.slots().zip(to.slots()))
    }

    /// Ends a step: everything is where the animation had it at the end.
    pub fn arrive(&mut self) {
        self.places_mut().into_iter().for_each(AnimatedColumns::arrive);
        self.backstops.normal.arrive();
    }

    pub fn is_finite(&self) -> bool {
        let Self { limits, backstops, drives } = self;
        let columns = [&limits.centre, &backstops.place, &backstops.normal, &drives.place];
        columns.into_iter().all(AnimatedColumns::is_finite)
    }

    /// Moves all places, which are relative to the body's origin.
    pub fn shift(&mut self, shift: Vec3) {
        self.places_mut().into_iter().for_each(|places| places.change(|place| place + shift));
    }

    /// Turns all places about the body's origin, and all normals.
    pub fn turn(&mut self, turn: impl Fn(Vec3) -> Vec3) {
        self.places_mut().into_iter().for_each(|places| places.change(&turn));
        self.backstops.normal.change(turn);
    }

    fn places_mut(&mut self) -> [&mut AnimatedColumns; 3] {
        let Self { limits, backstops, drives } = self;
        [&mut limits.centre, &mut backstops.place, &mut drives.place]
    }

    /// Upper bound in metres on the way that limits and backstops move a particle at `position` in `slot`.
    pub fn pull(&self, slot: usize, position: Vec3) -> f32 {
        let limit = self.limits.get(slot).map(|([_, target], reach)| target.distance(position) - reach);
        let backstop = self.backstops.get(slot).map(|backstop| {
            let [now, next] = self.backstops.centres(slot);
            let depth = backstop.radius - now.distance(position).min(next.distance(position));
            depth.max(0.0) + now.distance(next)
        });
        limit.unwrap_or(0.0).max(0.0) + backstop.unwrap_or(0.0)
    }
}
