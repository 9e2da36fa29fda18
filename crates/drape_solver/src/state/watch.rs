//! The watch over a body that is expected to touch nothing of itself: how far its particles are off their ways.
//!
//! A way leads evenly from where a particle was when the watch began. Each strip keeps, lane by lane, a box around how far its
//! particles have been off at the ends of substeps. In a grid a lane of a strip is a patch of neighbours.
//!
//! Design: `docs/design/self_contact.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::geometry::lane_boxes::{CellBoxes, LaneBoxes};
use crate::simd::columns::Cell;
use crate::simd::lanes::Lanes3;
use crate::state::layout::Layout;

/// The ways of a body's particles, and how far they are off.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch {
    /// Places when the watch began, and the way of each particle in a substep, in metres.
    pub starts: Vec<Cell>,
    pub ways: Vec<Cell>,
    /// For each strip, boxes around how far the particles in its lanes are off, in metres; empty if nothing is watched.
    pub off: Vec<CellBoxes>,
    /// The number of the first substep.
    since: u32,
}

impl Watch {
    /// Notes the ways from these `starts` that are as far in each substep, from substep `since` on. Nothing is watched yet.
    pub fn prepare(&mut self, starts: &[Cell], ways: &[Cell], since: u32) {
        self.end();
        self.starts.clear();
        self.starts.extend_from_slice(starts);
        self.ways.clear();
        self.ways.extend_from_slice(ways);
        self.since = since;
    }

    /// Notes the ways from these `starts` to where the particles are one substep later.
    pub fn prepare_towards(&mut self, starts: &[Cell], next: &[Cell], since: u32) {
        self.prepare(starts, next, since);
        self.ways.iter_mut().zip(starts).for_each(|(way, start)| *way = way.minus(start));
    }

    pub fn begin(&mut self, layout: &Layout) {
        let (_, strips) = layout.strips();
        self.off.clear();
        self.off.resize(strips, CellBoxes::NOTHING);
    }

    pub fn end(&mut self) {
        self.off.clear();
    }

    pub fn rows(&mut self) -> WatchRows<'_> {
        let Self { starts, ways, off, since } = self;
        WatchRows { starts, ways, off, since: *since }
    }
}

/// The watch over some strips of a body.
pub(crate) struct WatchRows<'a> {
    starts: &'a [Cell],
    ways: &'a [Cell],
    off: &'a mut [CellBoxes],
    since: u32,
}

impl WatchRows<'_> {
    pub fn is_on(&self) -> bool {
        !self.off.is_empty()
    }

    /// Splits it above a strip, and above a cell, counted here.
    pub fn split_at(&mut self, strip: usize, cell: usize) -> (WatchRows<'_>, WatchRows<'_>) {
        let &mut Self { starts, ways, ref mut off, since } = self;
        let (starts, ways) = (starts.split_at(cell.min(starts.len())), ways.split_at(cell.min(ways.len())));
        let off = off.split_at_mut(strip.min(off.len()));
        (
            WatchRows { starts: starts.0, ways: ways.0, off: off.0, since },
            WatchRows { starts: starts.1, ways: ways.1, off: off.1, since },
        )
    }

    /// Widens the boxes of some strips, counted here, by where their particles are at the end of substep `index`.
    #[inline(always)]
    pub fn note<S: Simd>(
        &mut self,
        simd: S,
        position: &[Cell],
        strips: Range<usize>,
        cells_of_strip: usize,
        index: u32,
    ) {
        let part = f32x16::splat(simd, (index + 1 - self.since) as f32);
        for strip in strips {
            let first = strip * cells_of_strip;
            let cells = first..(first + cells_of_strip).min(position.len());
            let mut off = LaneBoxes::load(simd, &self.off[strip]);
            let ways = self.starts[cells.clone()].iter().zip(&self.ways[cells.clone()]);
            for ((start, way), now) in ways.zip(&position[cells]) {
                let expected = Lanes3::load(simd, start).plus(Lanes3::load(simd, way).times(part));
                off = off.and(LaneBoxes::of(Lanes3::load(simd, now).minus(expected)));
            }
            off.store(&mut self.off[strip]);
        }
    }
}
