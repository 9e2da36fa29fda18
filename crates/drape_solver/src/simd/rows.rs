//! Rows: positions and inverse masses as [x, y, z, w], one particle a row, while listed sticks are relaxed and listed bends solved.
//!
//! A stick of no particular pattern takes its ends from anywhere. In a cell, an end lies in three lines of the cache,
//! number by number; as a row, it is loaded and stored at once. Of sticks only a window of the body is kept as rows: the *blocks*
//! of particles that the sweep of [`listed`](crate::constraint::listed_stick) is at work on. Bends keep the whole body.
//!
//! ```text
//!   cells  | block 0 | block 1 | block 2 | block 3 | block 4 | ...
//!             done     put back   sticks    sticks    taken
//! ```
//!
//! Design: `docs/design/listed_sticks.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x4, f32x16, prelude::*};

use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load};

/// The number of particles in a block.
pub(crate) const BLOCK: usize = 512;

/// The number of blocks in a window that holds the whole body.
pub(crate) const ALL_BLOCKS: usize = usize::MAX;

/// The number of cells in a block.
const BLOCK_CELLS: usize = BLOCK / LANES;

/// The number of blocks that `cells` cells fill.
#[inline(always)]
pub(crate) fn block_count(cells: usize) -> usize {
    cells.div_ceil(BLOCK_CELLS)
}

/// A window of blocks as rows, in which blocks take turns. The number of rows is a power of two.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    rows: Vec<[f32; 4]>,
}

impl Rows {
    /// Makes room for `window` blocks of a body of `cells` cells, reusing what is allocated.
    pub fn reset(&mut self, window: usize, cells: usize) {
        let blocks = window.min(block_count(cells));
        let count = (blocks * BLOCK).min(cells * LANES);
        self.rows.resize(if count == 0 { 0 } else { count.next_power_of_two() }, [0.0; 4]);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.rows)
    }

    /// The rows of a block.
    #[inline(always)]
    fn place(&self, block: usize) -> Range<usize> {
        let first = (block * BLOCK) & (self.rows.len() - 1);
        first..self.rows.len().min(first + BLOCK)
    }

    /// Takes the particles of a block out of their cells.
    ///
    /// The inverse mass of a pin is stored as infinity, so that it equals no other, not even that of a second pin.
    #[inline(always)]
    pub fn take<S: Simd>(&mut self, simd: S, block: usize, position: &[Cell], inverse_mass: &[[f32; LANES]]) {
        let rows = self.place(block);
        let rows = self.rows[rows].as_chunks_mut::<LANES>().0;
        let cells = block * BLOCK_CELLS..position.len().min((block + 1) * BLOCK_CELLS);
        let pinned = f32x16::splat(simd, f32::INFINITY);
        for ((cell, masses), rows) in position[cells.clone()].iter().zip(&inverse_mass[cells]).zip(rows) {
            let Lanes3 { x, y, z } = Lanes3::load(simd, cell);
            let w = load(simd, masses);
            let w = w.simd_gt(f32x16::splat(simd, 0.0)).select(w, pinned);
            store_rows(rows, [x, y, z, w]);
        }
    }

    /// Takes all particles out of their cells, if the window holds the whole body.
    #[inline(always)]
    pub fn take_all<S: Simd>(&mut self, simd: S, position: &[Cell], inverse_mass: &[[f32; LANES]]) {
        for block in 0..block_count(position.len()) {
            self.take(simd, block, position, inverse_mass);
        }
    }

    /// Puts the positions of a block back into their cells.
    #[inline(always)]
    pub fn put_back<S: Simd>(&self, simd: S, block: usize, position: &mut [Cell]) {
        let rows = self.rows[self.place(block)].as_chunks::<LANES>().0;
        let cells = block * BLOCK_CELLS..position.len().min((block + 1) * BLOCK_CELLS);
        for (cell, rows) in position[cells].iter_mut().zip(rows) {
            lanes_of_rows(simd, rows).store(cell);
        }
    }

    /// Puts all positions back into their cells, if the window holds the whole body.
    #[inline(always)]
    pub fn put_back_all<S: Simd>(&self, simd: S, position: &mut [Cell]) {
        for block in 0..block_count(position.len()) {
            self.put_back(simd, block, position);
        }
    }

    /// Makes all rows zero.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.rows.fill([0.0; 4]);
    }

    /// The rows of each cell, four to an array, if the window holds the whole body; behind them rows of no particle may follow.
    #[inline(always)]
    pub fn quarters(&self) -> &[[[f32; LANES]; 4]] {
        self.rows.as_flattened().as_chunks().0.as_chunks().0
    }

    /// The same, to be changed.
    #[inline(always)]
    pub fn quarters_mut(&mut self) -> &mut [[[f32; LANES]; 4]] {
        self.rows.as_flattened_mut().as_chunks_mut().0.as_chunks_mut().0
    }

    /// The rows by the places of particles.
    #[inline(always)]
    pub fn window(&mut self) -> Window<'_> {
        // Lets the compiler see that no place lies outside.
        let mask = (4 * self.rows.len() as u32).saturating_sub(4);
        Window { rows: &mut self.rows.as_flattened_mut()[..mask as usize + 4], mask }
    }
}

/// Rows by the place of their first number, which is four times the slot.
pub(crate) struct Window<'a> {
    rows: &'a mut [f32],
    mask: u32,
}

impl Window<'_> {
    /// The place of a row in the window.
    #[inline(always)]
    pub fn place(&self, first: u32) -> usize {
        (first & self.mask) as usize
    }

    #[inline(always)]
    pub fn get<S: Simd>(&self, simd: S, place: usize) -> f32x4<S> {
        f32x4::from_slice(simd, &self.rows[place..place + 4])
    }

    #[inline(always)]
    pub fn set<S: Simd>(&mut self, place: usize, row: f32x4<S>) {
        row.store_slice(&mut self.rows[place..place + 4]);
    }
}

/// Rows as columns: eight rows, two to a vector, or sixteen, four to a vector.
#[inline(always)]
pub(crate) fn columns_of_rows<S: Simd, V: SimdBase<S>>([first, second, third, fourth]: [V; 4]) -> [V; 4] {
    // Each deinterleaving halves the distance of numbers of one column.
    let (low_xz, low_yw) = first.deinterleave(second);
    let (high_xz, high_yw) = third.deinterleave(fourth);
    let (x, z) = low_xz.deinterleave(high_xz);
    let (y, w) = low_yw.deinterleave(high_yw);
    [x, y, z, w]
}

/// The inverse of [`columns_of_rows`].
#[inline(always)]
pub(crate) fn rows_of_columns<S: Simd, V: SimdBase<S>>([x, y, z, w]: [V; 4]) -> [V; 4] {
    let (low_xz, high_xz) = x.interleave(z);
    let (low_yw, high_yw) = y.interleave(w);
    let (first, second) = low_xz.interleave(low_yw);
    let (third, fourth) = high_xz.interleave(high_yw);
    [first, second, third, fourth]
}

/// Stores sixteen rows, given as columns.
#[inline(always)]
pub(crate) fn store_rows<S: Simd>(rows: &mut [[f32; 4]; LANES], columns: [f32x16<S>; 4]) {
    let quarters = rows.as_flattened_mut().as_chunks_mut::<LANES>().0;
    for (quarter, values) in quarters.iter_mut().zip(rows_of_columns(columns)) {
        *quarter = values.to_array();
    }
}

/// The first three columns of sixteen rows.
#[inline(always)]
pub(crate) fn lanes_of_rows<S: Simd>(simd: S, rows: &[[f32; 4]; LANES]) -> Lanes3<S> {
    let quarters = rows.as_flattened().as_chunks::<LANES>().0;
    let [first, second, third, fourth] = [&quarters[0], &quarters[1], &quarters[2], &quarters[3]];
    let rows = [load(simd, first), load(simd, second), load(simd, third), load(simd, fourth)];
    let [x, y, z, _] = columns_of_rows(rows);
    Lanes3 { x, y, z }
}
