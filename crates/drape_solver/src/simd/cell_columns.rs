//! Columns of cells, for threads that share a body from side to side.
//!
//! ```text
//!   width 4   0   1 | 2   3      Cells lie row after row. Cut between two columns, each side has cells all over the memory,
//!             4   5 | 6   7      so that no slice can be split there.
//!             8   9 | 10  11
//! ```
//!
//! Design: `docs/design/sweeps_and_threads.md`.

#![expect(unsafe_code, reason = "the two sides of a cut lie interleaved in memory")]
#![expect(
    clippy::needless_pass_by_ref_mut,
    reason = "only one may have a column at a time: clippy does not see through pointers"
)]

use core::marker::PhantomData;
use core::ops::Range;
use core::ptr::NonNull;

use crate::simd::columns::Cell;

/// Some columns of cells, for one thread.
pub(crate) struct CellColumns<'a> {
    /// The first cell of the whole: the upper end of column 0.
    first: NonNull<Cell>,
    rows: usize,
    width: usize,
    columns: Range<usize>,
    cells: PhantomData<&'a mut [Cell]>,
}

// SAFETY: it is the only way to its cells while it lives, as a `&mut [Cell]` would be.
unsafe impl Send for CellColumns<'_> {}

impl<'a> CellColumns<'a> {
    /// All columns of `cells`, which lie in rows of `width`.
    pub fn new(cells: &'a mut [Cell], width: usize) -> Self {
        let rows = cells.len() / width;
        Self { first: NonNull::from(cells).cast(), rows, width, columns: 0..width, cells: PhantomData }
    }

    /// The same columns, for a shorter time.
    pub fn reborrow(&mut self) -> CellColumns<'_> {
        let &mut Self { first, rows, width, ref columns, .. } = self;
        CellColumns { first, rows, width, columns: columns.clone(), cells: PhantomData }
    }

    /// Splits them in two before `column`.
    pub fn split_at(&mut self, column: usize) -> [CellColumns<'_>; 2] {
        let Range { start, end } = self.columns;
        assert!((start..=end).contains(&column), "column {column} is not in {start}..{end}");
        let &mut Self { first, rows, width, .. } = self;
        [start..column, column..end].map(|columns| CellColumns {
            first,
            rows,
            width,
            columns,
            cells: PhantomData,
        })
    }

    /// One of the columns.
    pub fn column(&mut self, column: usize) -> CellColumn<'_> {
        assert!(self.columns.contains(&column), "column {column} is not in {:?}", self.columns);
        let &mut Self { first, rows, width, .. } = self;
        CellColumn { first, rows, width, column, cells: PhantomData }
    }

    /// The cells of these columns in one row.
    pub fn row(&mut self, row: usize) -> &mut [Cell] {
        assert!(row < self.rows, "row {row} is not one of {}", self.rows);
        let Range { start, end } = self.columns;
        // SAFETY: the cells follow each other in the slice that `new` has borrowed for 'a, no other `CellColumns` has these
        // columns, and this one is borrowed for as long as the cells are.
        unsafe {
            core::slice::from_raw_parts_mut(self.first.add(row * self.width + start).as_ptr(), end - start)
        }
    }
}

/// One column of cells.
pub(crate) struct CellColumn<'a> {
    first: NonNull<Cell>,
    rows: usize,
    width: usize,
    column: usize,
    cells: PhantomData<&'a mut CellColumns<'a>>,
}

impl<'a> CellColumn<'a> {
    /// Cells that follow each other.
    pub fn new(cells: &'a mut [Cell]) -> Self {
        Self {
            rows: cells.len(),
            first: NonNull::from(cells).cast(),
            width: 1,
            column: 0,
            cells: PhantomData,
        }
    }

    /// The index of a row's cell among all cells that this column is a part of.
    #[inline(always)]
    pub fn place(&self, row: usize) -> usize {
        row * self.width + self.column
    }

    #[inline(always)]
    pub fn get(&self, row: usize) -> &Cell {
        assert!(row < self.rows);
        // SAFETY: the cell is in the slice that is borrowed for 'a, of which this is the only way to the column.
        unsafe { self.first.add(self.place(row)).as_ref() }
    }

    #[inline(always)]
    pub fn get_mut(&mut self, row: usize) -> &mut Cell {
        assert!(row < self.rows);
        // SAFETY: as in `get`; and the column is borrowed for as long as the cell is.
        unsafe { self.first.add(self.place(row)).as_mut() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    fn cells(count: usize) -> Vec<Cell> {
        vec![Cell::default(); count]
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn threads_write_to_columns_side_by_side() {
        let mut all = cells(3 * 5 + 1);
        let mut columns = CellColumns::new(&mut all, 5);
        let [mut left, mut right] = columns.split_at(2);
        let [mut middle, mut last] = right.split_at(4);
        thread::scope(|scope| {
            for (part, columns) in [(&mut left, 0..2), (&mut middle, 2..4), (&mut last, 4..5)] {
                scope.spawn(move || {
                    for column in columns {
                        let mut cells = part.column(column);
                        for row in 0..3 {
                            let place = cells.place(row) as f32;
                            cells.get_mut(row).x[0] = place;
                            assert_eq!(cells.get(row).x[0], place);
                        }
                    }
                    part.row(1).iter_mut().for_each(|cell| cell.y[0] = cell.x[0]);
                });
            }
        });
        for (i, cell) in all[..15].iter().enumerate() {
            assert_eq!(cell.x[0], i as f32);
            assert_eq!(cell.y[0], if i / 5 == 1 { i as f32 } else { 0.0 });
        }
        assert_eq!(all[15], Cell::default(), "it is in no whole row");
    }

    #[test]
    fn cells_that_follow_each_other_are_a_column() {
        let mut all = cells(3);
        CellColumn::new(&mut all).get_mut(2).z[5] = 1.0;
        assert_eq!(all[2].z[5], 1.0);
    }

    #[test]
    #[should_panic(expected = "column 1 is not in 0..1")]
    fn a_column_of_another_thread_is_out_of_reach() {
        let mut all = cells(6);
        let mut columns = CellColumns::new(&mut all, 3);
        let [mut left, _] = columns.split_at(1);
        left.column(1);
    }

    #[test]
    #[should_panic(expected = "row < self.rows")]
    fn a_row_that_is_not_whole_is_out_of_reach() {
        let mut all = cells(7);
        CellColumns::new(&mut all, 3).column(0).get(2);
    }
}
