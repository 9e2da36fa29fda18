//! Rows: positions and inverse masses as [x, y, z, w], one particle a row, while listed sticks are relaxed.
//!
//! A stick of no particular pattern takes its ends from anywhere. In a cell, an end lies in three lines of the cache,
//! number by number; as a row, it is loaded and stored at once. Only a window of the body is kept as rows: the *blocks*
//! of particles that the sweep of [`listed`](crate::listed) is at work on.
//!
//! ```text
//!   cells  | block 0 | block 1 | block 2 | block 3 | block 4 | ...
//!             done     put back   sticks    sticks    taken
//! ```

use fearless_simd::{Simd, f32x4, prelude::*};

use crate::columns::{Cell, LANES};

/// Particles of a block.
pub(crate) const BLOCK: usize = 256;

/// Cells of a block.
const BLOCK_CELLS: usize = BLOCK / LANES;

/// The number of blocks that `cells` cells fill.
pub(crate) fn block_count(cells: usize) -> usize {
    cells.div_ceil(BLOCK_CELLS)
}

/// A window of blocks as rows. Blocks take turns in it; their number is a power of two, or all that there are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    rows: Vec<[f32; 4]>,
    /// Which bits of a slot tell its row.
    mask: usize,
}

impl Rows {
    /// Makes room for `window` blocks of a body of `cells` cells, reusing what is allocated.
    pub fn reset(&mut self, window: usize, cells: usize) {
        let all = block_count(cells);
        let ring = window.next_power_of_two();
        let (count, mask) = if ring < all { (ring, ring * BLOCK - 1) } else { (all, usize::MAX) };
        self.mask = mask;
        self.rows.resize(if window == 0 { 0 } else { count * BLOCK }, [0.0; 4]);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.rows)
    }

    /// Takes the particles of a block out of their cells.
    ///
    /// The inverse mass of a pin is kept as infinity: it so equals no other, not even that of a second pin.
    #[inline(always)]
    pub fn take<S: Simd>(
        &mut self,
        simd: S,
        block: usize,
        position: &[Cell],
        inverse_mass: &[[f32; LANES]],
    ) {
        let first = (block * BLOCK) & self.mask;
        let rows = self.rows[first..first + BLOCK].as_chunks_mut::<4>().0.as_chunks_mut::<4>().0;
        let cells = block * BLOCK_CELLS..position.len().min((block + 1) * BLOCK_CELLS);
        for ((cell, masses), rows) in position[cells.clone()].iter().zip(&inverse_mass[cells]).zip(rows) {
            for (quarter, rows) in rows.iter_mut().enumerate() {
                let column =
                    |values: &[f32; LANES]| f32x4::load_array_ref(simd, &values.as_chunks::<4>().0[quarter]);
                let w = column(masses);
                let w = w.simd_gt(f32x4::splat(simd, 0.0)).select(w, f32x4::splat(simd, f32::INFINITY));
                let columns = [column(&cell.x), column(&cell.y), column(&cell.z), w];
                for (row, values) in rows.iter_mut().zip(transposed(columns)) {
                    *row = values.to_array();
                }
            }
        }
    }

    /// Puts the positions of a block back into their cells.
    #[inline(always)]
    pub fn put_back<S: Simd>(&self, simd: S, block: usize, position: &mut [Cell]) {
        let first = (block * BLOCK) & self.mask;
        let rows = self.rows[first..first + BLOCK].as_chunks::<4>().0.as_chunks::<4>().0;
        let cells = block * BLOCK_CELLS..position.len().min((block + 1) * BLOCK_CELLS);
        for (cell, rows) in position[cells].iter_mut().zip(rows) {
            for (quarter, rows) in rows.iter().enumerate() {
                let [x, y, z, _] = transposed(rows.each_ref().map(|row| f32x4::load_array_ref(simd, row)));
                cell.x.as_chunks_mut::<4>().0[quarter] = x.to_array();
                cell.y.as_chunks_mut::<4>().0[quarter] = y.to_array();
                cell.z.as_chunks_mut::<4>().0[quarter] = z.to_array();
            }
        }
    }

    /// The row of a slot.
    #[inline(always)]
    pub fn of(&mut self, slot: u32) -> &mut [f32; 4] {
        &mut self.rows[slot as usize & self.mask]
    }
}

/// Rows as columns, and columns as rows.
#[inline(always)]
pub(crate) fn transposed<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    // Each zip brings two numbers side by side that are to be two apart.
    let (ac_low, ac_high) = a.interleave(c);
    let (bd_low, bd_high) = b.interleave(d);
    let (x, y) = ac_low.interleave(bd_low);
    let (z, w) = ac_high.interleave(bd_high);
    [x, y, z, w]
}
