//! Limits on motion: how far a particle may be from a place that an animation gives it.
//!
//! ```text
//!        . - .
//!      .   c---x    c  where the animation has the particle
//!        . - .      x  where it is: at most its distance away, put back onto the ball where it is farther
//! ```
//!
//! The last word of each substep, after contacts and friction. Velocities follow, so that what is held back does not swing on. Between
//! two steps a centre travels evenly over the substeps, as a pin does.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::constants::{AT_LIMIT, LIMIT_CONFLICT_DEPTH};
use crate::simd::columns::{Columns, LANES};
use crate::simd::lanes::{Lanes3, load};
use crate::state::body::{Body, BodyContext};
use crate::state::layout::Layout;
use crate::state::particles::Particles;
use crate::substep::sweep::Surroundings;
use crate::substep::work::{Common, Moving};

/// The limits of a body's particles, by slot; empty where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MotionLimits {
    /// Middle of each limit, relative to the body's origin.
    pub centre: Columns,
    /// Where that is to be at the end of the next step.
    pub target: Columns,
    /// How far the particle may be from it, in metres; infinite without a limit.
    pub reach: Vec<f32>,
}

impl MotionLimits {
    pub fn is_empty(&self) -> bool {
        self.reach.is_empty()
    }

    /// Room for those of `cells` cells, none of which has a limit yet.
    pub fn reset(&mut self, cells: usize) {
        self.centre.reset(cells);
        self.target.reset(cells);
        self.reach.clear();
        self.reach.resize(cells * LANES, f32::INFINITY);
    }

    pub fn clear(&mut self) {
        *self = Self::default();
    }

    pub fn set(&mut self, slot: usize, centre: Vec3, target: Vec3, reach: f32) {
        self.centre.set(slot, centre);
        self.target.set(slot, target);
        self.reach[slot] = reach;
    }

    /// Centre, its target and reach, if there is a limit.
    pub fn get(&self, slot: usize) -> Option<(Vec3, Vec3, f32)> {
        let reach = self.reach.get(slot).copied().filter(|reach| *reach < f32::INFINITY)?;
        Some((self.centre.get(slot), self.target.get(slot), reach))
    }

    /// The same limits in the slots of another layout.
    pub fn arranged(&self, from: &Layout, to: &Layout) -> Self {
        let mut arranged = Self::default();
        if !self.is_empty() {
            arranged.reset(to.cells());
            for (from, to) in from.slots().zip(to.slots()) {
                if let Some((centre, target, reach)) = self.get(from) {
                    arranged.set(to, centre, target, reach);
                }
            }
        }
        arranged
    }

    /// Brings centres to where they were to be.
    pub fn arrive(&mut self) {
        self.centre.cells.clone_from_slice(&self.target.cells);
    }

    pub fn is_finite(&self) -> bool {
        let mut columns = self.centre.cells.iter().chain(&self.target.cells);
        columns.all(|cell| cell.axes().into_iter().flatten().all(|value| value.is_finite()))
    }

    /// Puts the free particles of `cells`, which are at `places` in the columns that move, back into their limits, as they are at
    /// this fraction of the step.
    #[inline(always)]
    pub fn enforce<S: Simd>(
        &self,
        simd: S,
        moving: &mut Moving,
        places: Range<usize>,
        rest: &Common,
        cells: Range<usize>,
        fraction: f32,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        let fraction = f32x16::splat(simd, fraction);
        let (reaches, _) = self.reach.as_chunks::<LANES>();
        for (place, cell) in places.zip(cells) {
            let reach = load(simd, &reaches[cell]);
            let start = Lanes3::load(simd, &self.centre.cells[cell]);
            let end = Lanes3::load(simd, &self.target.cells[cell]);
            let centre = start.plus(end.minus(start).times(fraction));
            let position = Lanes3::load(simd, &moving.position[place]);
            let offset = position.minus(centre);
            let squared = offset.dot(offset);
            let is_free: mask32x16<S> = load(simd, &rest.inverse_mass[cell]).simd_gt(zero);
            let is_beyond = squared.simd_gt(reach * reach) & is_free;
            if !is_beyond.any_true() {
                continue;
            }
            let back = centre.plus(offset.times(reach / squared.sqrt()));
            let displacement = Lanes3::load(simd, &moving.displacement[place]);
            displacement
                .plus(back.minus(position))
                .or(is_beyond, displacement)
                .store(&mut moving.displacement[place]);
            back.or(is_beyond, position).store(&mut moving.position[place]);
        }
    }
}

impl Particles {
    /// Keeps particle `i` within `distance` (metres) of `centre` (world, metres), whatever pulls or pushes it, obstacles included:
    /// the least that an animation may ask of a cloth. An infinite distance is no limit; one that is negative or not a number
    /// counts as 0. Pinned particles have their pin for a limit.
    ///
    /// The centre is moved by [`set_limit_centre`](Self::set_limit_centre).
    pub fn set_motion_limit(&mut self, i: usize, centre: Vec3, distance: f32) {
        let slot = self.slot(i);
        if self.limits.is_empty() {
            if distance == f32::INFINITY {
                return;
            }
            self.limits.reset(self.layout.cells());
        }
        let centre = centre - self.origin;
        self.limits.set(slot, centre, centre, distance.max(0.0));
        self.disturb();
    }

    /// Moves the middle of particle `i`'s limit to `centre` (world, metres) within the next step, evenly over the substeps. Without
    /// a limit this does nothing.
    pub fn set_limit_centre(&mut self, i: usize, centre: Vec3) {
        let slot = self.slot(i);
        let centre = centre - self.origin;
        if self.limits.get(slot).is_some_and(|(_, target, _)| target != centre) {
            self.limits.target.set(slot, centre);
            self.disturb();
        }
    }

    /// The middle of particle `i`'s limit in the world, as of the end of the last step, and its distance, in metres; none without a
    /// limit.
    pub fn motion_limit(&self, i: usize) -> Option<(Vec3, f32)> {
        self.limits.get(self.slot(i)).map(|(centre, _, reach)| (self.origin + centre, reach))
    }

    /// Takes off all limits.
    pub fn clear_motion_limits(&mut self) {
        if !self.limits.is_empty() {
            self.limits.clear();
            self.disturb();
        }
    }
}

impl BodyContext {
    /// Particles that were deeper in an obstacle at the end of the last step than contacts leave them, as their
    /// [limit](Particles::set_motion_limit) let them go no farther.
    pub fn limit_conflicts(&self) -> usize {
        self.limit_conflicts.len()
    }
}

/// Counts the particles that a limit keeps in an obstacle, at the end of a step.
pub(crate) fn count_conflicts(body: &mut Body, around: Surroundings) {
    let Body { particles, settings, context, .. } = body;
    let BodyContext { contacts, limit_conflicts, .. } = context;
    limit_conflicts.clear();
    if particles.limits.is_empty() {
        return;
    }
    for candidate in &contacts.candidates {
        let obstacle = &around.obstacles[contacts.groups[usize::from(candidate.group)].obstacle];
        let lanes = (0..LANES).filter(|lane| candidate.lanes & (1 << lane) != 0);
        for slot in lanes.map(|lane| candidate.cell as usize * LANES + lane) {
            let Some((_, centre, reach)) = particles.limits.get(slot) else { continue };
            let position = particles.position.get(slot);
            if particles.inverse_mass[slot] == 0.0 || position.distance(centre) < reach - AT_LIMIT {
                continue;
            }
            let local = obstacle.pose_at(1.0, particles.origin).to_local(position);
            let depth = settings.thickness - obstacle.shape().surface(local).distance;
            if depth > LIMIT_CONFLICT_DEPTH {
                limit_conflicts.push(slot as u32);
            }
        }
    }
    limit_conflicts.sort_unstable();
    limit_conflicts.dedup();
}
