//! Limits on motion as data: the greatest distance of each particle from its animated place.
//!
//! `constraint/motion_limit.rs` enforces them.
//!
//! Design: `docs/design/characters.md`.

use glam::Vec3;

use crate::simd::columns::LANES;
use crate::state::animated_columns::AnimatedColumns;
use crate::state::particles::Particles;

/// The limits of a body's particles, by slot; empty where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MotionLimits {
    /// Middle of each limit, relative to the body's origin.
    pub centre: AnimatedColumns,
    /// Greatest distance of the particle from the middle, in metres; infinite without a limit.
    pub reach: Vec<f32>,
}

impl MotionLimits {
    pub fn is_empty(&self) -> bool {
        self.reach.is_empty()
    }

    /// Makes room for the particles of `cells` cells, all without a limit.
    pub fn reset(&mut self, cells: usize) {
        self.centre.reset(cells);
        self.reach.clear();
        self.reach.resize(cells * LANES, f32::INFINITY);
    }

    pub fn set(&mut self, slot: usize, centre: [Vec3; 2], reach: f32) {
        self.centre.set(slot, centre);
        self.reach[slot] = reach;
    }

    /// Centre, now and at the end of the next step, and reach, if there is a limit.
    pub fn get(&self, slot: usize) -> Option<([Vec3; 2], f32)> {
        let reach = self.reach.get(slot).copied().filter(|reach| *reach < f32::INFINITY)?;
        Some((self.centre.get(slot), reach))
    }

    /// Copies the limit of a slot of another body, if there is one.
    pub fn copy(&mut self, to: usize, others: &Self, from: usize) {
        if let Some((centre, reach)) = others.get(from) {
            self.set(to, centre, reach);
        }
    }
}

impl Particles {
    /// Keeps particle `i` within `distance` (metres) of `centre` (world, metres), whatever pulls or pushes it: the
    /// limit overrules obstacles too. An infinite distance is no limit; a negative one or NaN counts as 0. A pinned
    /// particle follows its pin alone.
    ///
    /// [`set_limit_centre`](Self::set_limit_centre) moves the centre.
    pub fn set_motion_limit(&mut self, i: usize, centre: Vec3, distance: f32) {
        let slot = self.slot(i);
        if self.pose.limits.is_empty() {
            if distance == f32::INFINITY {
                return;
            }
            self.pose.limits.reset(self.layout.cells());
        }
        let centre = centre - self.origin;
        self.pose.limits.set(slot, [centre; 2], distance.max(0.0));
        self.disturb();
    }

    /// Moves the middle of particle `i`'s limit to `centre` (world, metres) within the next step, evenly over the
    /// substeps. Does nothing without a limit.
    pub fn set_limit_centre(&mut self, i: usize, centre: Vec3) {
        let slot = self.slot(i);
        let centre = centre - self.origin;
        let limits = &mut self.pose.limits;
        if limits.get(slot).is_some() && limits.centre.aim(slot, centre) {
            self.disturb();
        }
    }

    /// The middle of particle `i`'s limit at the end of the last step (world), and its distance, in metres; none
    /// without a limit.
    pub fn motion_limit(&self, i: usize) -> Option<(Vec3, f32)> {
        self.pose.limits.get(self.slot(i)).map(|([centre, _], reach)| (self.origin + centre, reach))
    }

    /// Removes all limits.
    pub fn clear_motion_limits(&mut self) {
        if !self.pose.limits.is_empty() {
            self.pose.limits = MotionLimits::default();
            self.disturb();
        }
    }
}
