//! Vectors that an animation moves, for each particle: now, and at the end of the next step.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

use crate::simd::columns::{Cell, Columns, LANES};
use crate::simd::lanes::Lanes3;

/// Places relative to a body's origin, or directions, of its particles by slot.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct AnimatedColumns {
    pub now: Columns,
    pub next: Columns,
}

impl AnimatedColumns {
    /// Makes room for the particles of `cells` cells.
    pub fn reset(&mut self, cells: usize) {
        self.now.reset(cells);
        self.next.reset(cells);
    }

    pub fn set(&mut self, slot: usize, [now, next]: [Vec3; 2]) {
        self.now.set(slot, now);
        self.next.set(slot, next);
    }

    /// Now, and at the end of the next step.
    pub fn get(&self, slot: usize) -> [Vec3; 2] {
        [self.now.get(slot), self.next.get(slot)]
    }

    /// The vectors of a cell at this fraction of the step, between which they travel evenly.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, cell: usize, fraction: f32) -> Lanes3<S> {
        let now = Lanes3::load(simd, &self.now.cells[cell]);
        let next = Lanes3::load(simd, &self.next.cells[cell]);
        now.plus(next.minus(now).times(f32x16::splat(simd, fraction)))
    }

    /// Sets where it goes in the next step. True if that is another place than before.
    pub fn aim(&mut self, slot: usize, next: Vec3) -> bool {
        let is_other = self.next.get(slot) != next;
        self.next.set(slot, next);
        is_other
    }

    /// Ends a step.
    pub fn arrive(&mut self) {
        self.now.cells.clone_from_slice(&self.next.cells);
    }

    /// Replaces each vector by what `change` makes of it.
    pub fn change(&mut self, change: impl Fn(Vec3) -> Vec3) {
        for columns in [&mut self.now, &mut self.next] {
            (0..columns.cells.len() * LANES).for_each(|slot| columns.set(slot, change(columns.get(slot))));
        }
    }

    pub fn is_finite(&self) -> bool {
        let cells = self.now.cells.iter().chain(&self.next.cells);
        cells.flat_map(Cell::axes).flatten().all(|value| value.is_finite())
    }
}
