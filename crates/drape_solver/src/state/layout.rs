//! The layout of a body's particles in memory: it maps a particle's index to its slot in the columns, and back.
//!
//! Columns are stored in cells of [`LANES`] particles, and kernels work on whole cells. Neighbours on a grid must *not*
//! share a cell, as a stick would then join two lanes of one vector. Each lane holds a patch of the grid instead, and
//! the same place in every patch makes a cell:
//!
//! ```text
//!   one row of 16 columns in 4 patches          cells of the row
//!   | 0 1 2 3 | 4 5 6 7 | 8 9 a b | c d e f |   (0 4 8 c) (1 5 9 d) (2 6 a e) (3 7 b f)
//!     lane 0    lane 1    lane 2    lane 3      sticks 0-1, 4-5, 8-9, c-d: two aligned vectors
//! ```
//!
//! A stick from one patch into the next joins a lane to the next lane, so the kernel shifts the vector. Slots that the
//! grid does not fill are *ghosts*: they have no mass, and no stick reaches them.
//!
//! Design: `docs/design/memory_layout.md`.

use std::sync::Arc;

use crate::constants::CELLS_AT_ONCE;
use crate::simd::columns::LANES;
use crate::state::grid::{Band, GridRun, GridRuns};
use crate::state::renumbering::Renumbering;
use crate::state::torn_grid::TornGrid;

/// The arrangement of a body's particles in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// In order of the index.
    Linear { count: usize },
    /// In an order that keeps particles joined by sticks near each other.
    Renumbered(Arc<Renumbering>),
    /// A grid, in patches.
    Grid(Grid),
    /// The remains of a torn grid, and the particles that were split from it.
    Torn(Arc<TornGrid>),
}

/// A grid of particles, one patch for each lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    pub columns: usize,
    pub rows: usize,
    /// The numbers of patches side by side and one below another; their product is at most [`LANES`].
    pub across: usize,
    pub down: usize,
    /// Columns and rows of one patch.
    pub width: usize,
    pub height: usize,
}

impl Default for Layout {
    fn default() -> Self {
        Self::Linear { count: 0 }
    }
}

impl Layout {
    /// The number of particles.
    pub fn count(&self) -> usize {
        match self {
            Self::Linear { count } => *count,
            Self::Renumbered(renumbering) => renumbering.count(),
            Self::Grid(grid) => grid.columns * grid.rows,
            Self::Torn(torn) => torn.count(),
        }
    }

    /// The number of cells that hold them.
    pub fn cells(&self) -> usize {
        match self {
            Self::Linear { .. } | Self::Renumbered(_) => self.count().div_ceil(LANES),
            Self::Grid(grid) => grid.width * grid.height,
            Self::Torn(torn) => torn.cells(),
        }
    }

    /// The first cell of each strip in which a family of a grid has sticks, and the runs of those.
    #[inline]
    pub fn runs_by_strip<'a>(&self, runs: &'a GridRuns) -> impl Iterator<Item = (usize, &'a [GridRun])> {
        let (cells_of_strip, strips) = self.strips();
        let of_band = move |(band, runs): (&Band, &'a [GridRun])| {
            band.among(&(0..strips)).map(move |strip| (strip * cells_of_strip, runs))
        };
        runs.bands().flat_map(of_band)
    }

    /// The number of cells in a strip, and the number of strips. The last one may have fewer cells.
    pub fn strips(&self) -> (usize, usize) {
        match self {
            Self::Linear { .. } | Self::Renumbered(_) => {
                let cells = self.cells().clamp(1, CELLS_AT_ONCE);
                (cells, self.cells().div_ceil(cells))
            }
            Self::Grid(grid) => (grid.cells_of_strip(), grid.height.div_ceil(ROWS_OF_STRIP)),
            // Particles without a place in the grid follow behind its last strip.
            Self::Torn(torn) => {
                let cells = torn.grid.cells_of_strip();
                (cells, torn.cells().div_ceil(cells))
            }
        }
    }

    /// True if each row of the grid is a row of cells, so that a sweep may run down the strips.
    pub fn has_whole_rows(&self) -> bool {
        matches!(self.grid(), Some(grid) if grid.down == 1)
    }

    /// True if tears have emptied places of the grid, or left particles without one.
    pub fn is_torn(&self) -> bool {
        matches!(self, Self::Torn(_))
    }

    /// The grid, whole or torn, that decides the slots of particles; none in other layouts.
    pub fn grid(&self) -> Option<Grid> {
        match self {
            Self::Grid(grid) => Some(*grid),
            Self::Torn(torn) => Some(torn.grid),
            Self::Linear { .. } | Self::Renumbered(_) => None,
        }
    }

    /// The slot of particle `index`.
    #[inline]
    pub fn slot(&self, index: usize) -> usize {
        match self {
            Self::Linear { .. } => index,
            Self::Renumbered(renumbering) => renumbering.slot(index),
            Self::Grid(grid) => grid.slot(index % grid.columns, index / grid.columns),
            Self::Torn(torn) => torn.slot(index),
        }
    }

    /// The slots of all particles, in order of their indices.
    pub fn slots(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        let mut walk = match self {
            Self::Grid(grid) => Some(GridWalk::new(*grid)),
            _ => None,
        };
        (0..self.count()).map(move |index| walk.as_mut().map_or_else(|| self.slot(index), GridWalk::next))
    }

    /// The particle in `slot`; none in a ghost.
    pub fn index(&self, slot: usize) -> Option<usize> {
        match self {
            Self::Linear { count } => (slot < *count).then_some(slot),
            Self::Renumbered(renumbering) => renumbering.index(slot),
            Self::Grid(grid) => grid.index(slot),
            Self::Torn(torn) => torn.index(slot),
        }
    }

    /// Bit mask of the lanes of `cell` that hold a particle, lane 0 in the lowest bit.
    pub fn real_lanes(&self, cell: usize) -> u16 {
        match self {
            Self::Grid(grid) if grid.is_full() => u16::MAX,
            Self::Torn(torn) => torn.lanes(cell),
            Self::Linear { .. } | Self::Renumbered(_) if (cell + 1) * LANES <= self.count() => u16::MAX,
            _ => self.real_lanes_one_by_one(cell),
        }
    }

    fn real_lanes_one_by_one(&self, cell: usize) -> u16 {
        let is_real = |lane: usize| self.index(cell * LANES + lane).is_some();
        (0..LANES).fold(0, |bits, lane| bits | (u16::from(is_real(lane)) << lane))
    }
}

/// Rows of cells in a strip, the unit of a sweep: sticks down the rows begin in every second row, or in two of four.
pub(crate) const ROWS_OF_STRIP: usize = 2;

/// Least number of columns or rows of a patch: with fewer, a skip-one stick would end in its own cell.
const LEAST_PATCH: usize = 3;

/// The ways to cut a grid into patches: all in a row, which lets a sweep run down the rows; as a square, for grids
/// too small for that; all in a column.
const CUTS: [[usize; 2]; 3] = [[16, 1], [4, 4], [1, 16]];

impl Grid {
    /// The patches for a grid of this size; none if it is too small to be cut.
    pub fn new(columns: usize, rows: usize) -> Option<Self> {
        let cut = |&[across, down]: &[usize; 2]| {
            let (width, height) = (columns.div_ceil(across), rows.div_ceil(down));
            let is_fit = |patches, size, count: usize| {
                // Avoids empty patches in the middle of a short row, and more than a third of ghosts.
                patches == 1 || (size >= LEAST_PATCH && 2 * size * patches <= 3 * count)
            };
            (is_fit(across, width, columns) && is_fit(down, height, rows)).then_some(Self {
                columns,
                rows,
                across,
                down,
                width,
                height,
            })
        };
        CUTS.iter().find_map(cut)
    }

    /// The slot of the particle in this column and row.
    pub fn slot(self, column: usize, row: usize) -> usize {
        let lane = row / self.height * self.across + column / self.width;
        (row % self.height * self.width + column % self.width) * LANES + lane
    }

    /// Column and row of a slot.
    pub fn place(self, slot: usize) -> [usize; 2] {
        let (cell, lane) = (slot / LANES, slot % LANES);
        let column = lane % self.across * self.width + cell % self.width;
        let row = lane / self.across * self.height + cell / self.width;
        [column, row]
    }

    fn index(self, slot: usize) -> Option<usize> {
        let [column, row] = self.place(slot);
        (column < self.columns && row < self.rows).then_some(row * self.columns + column)
    }

    /// Bit mask of the lanes of the cells in this column of the patches whose column of the grid passes the test; lane 0 in the lowest bit.
    #[inline(always)]
    pub fn lanes_of_column(self, column: usize, is_one: impl Fn(usize) -> bool) -> u16 {
        let Self { across, down, width, .. } = self;
        let of_patches = (0..across)
            .fold(0_u16, |bits, patch| bits | (u16::from(is_one(patch * width + column)) << patch));
        (0..down).fold(0, |bits, patch| bits | (of_patches << (patch * across)))
    }

    /// The same of a row.
    #[inline(always)]
    pub fn lanes_of_row(self, row: usize, is_one: impl Fn(usize) -> bool) -> u16 {
        let Self { across, down, height, .. } = self;
        let of_patches = u16::MAX >> (LANES - across);
        let all = (0..down).filter(|&patch| is_one(patch * height + row));
        all.fold(0, |bits, patch| bits | (of_patches << (patch * across)))
    }

    /// True if there are no ghosts.
    fn is_full(self) -> bool {
        self.across * self.width == self.columns && self.down * self.height == self.rows
    }

    /// The number of cells in a strip.
    pub fn cells_of_strip(self) -> usize {
        ROWS_OF_STRIP * self.width
    }
}

/// Walks over the particles of a grid, row by row: without the divisions of [`Grid::slot`].
struct GridWalk {
    grid: Grid,
    column: usize,
    /// Column and row within the patch.
    within: [usize; 2],
    /// Column and row of the patch.
    patch: [usize; 2],
}

impl GridWalk {
    fn new(grid: Grid) -> Self {
        Self { grid, column: 0, within: [0; 2], patch: [0; 2] }
    }

    /// The slot of the next particle.
    fn next(&mut self) -> usize {
        let Self { grid, column, within, patch } = self;
        let slot = (within[1] * grid.width + within[0]) * LANES + patch[1] * grid.across + patch[0];
        *column += 1;
        within[0] += 1;
        if *column == grid.columns {
            *column = 0;
            (within[0], patch[0]) = (0, 0);
            within[1] += 1;
            if within[1] == grid.height {
                within[1] = 0;
                patch[1] += 1;
            }
        } else if within[0] == grid.width {
            within[0] = 0;
            patch[0] += 1;
        }
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;

    #[test]
    fn every_particle_has_a_slot_of_its_own_and_finds_back() {
        let sizes = [(16, 16), (48, 1), (13, 17), (64, 64), (4, 60), (100, 33), (67, 5)];
        for (columns, rows) in sizes.into_iter().take(unless_miri(7, 3)) {
            let layout = Layout::Grid(Grid::new(columns, rows).expect("large enough"));
            let mut slots: Vec<usize> = layout.slots().collect();
            for (index, &slot) in slots.iter().enumerate() {
                assert_eq!(slot, layout.slot(index));
                assert_eq!(layout.index(slot), Some(index));
                assert!(layout.real_lanes(slot / LANES) & (1 << (slot % LANES)) != 0);
            }
            let real: u32 = (0..layout.cells()).map(|cell| layout.real_lanes(cell).count_ones()).sum();
            assert_eq!(real as usize, layout.count());
            slots.sort_unstable();
            slots.dedup();
            assert_eq!(slots.len(), columns * rows);
            assert!(slots.last().is_some_and(|&last| last < layout.cells() * LANES));
        }
    }

    #[test]
    fn neighbours_are_never_in_one_cell() {
        for (columns, rows) in [(16, 16), (33, 40), (128, 9), (3, 48)].into_iter().take(unless_miri(4, 1)) {
            let grid = Grid::new(columns, rows).expect("large enough");
            for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
                for (right, down) in [(1, 0), (0, 1), (1, 1), (2, 0), (0, 2)] {
                    if column + right < columns && row + down < rows {
                        let cells = [grid.slot(column, row), grid.slot(column + right, row + down)];
                        assert_ne!(cells[0] / LANES, cells[1] / LANES);
                    }
                }
            }
        }
    }

    #[test]
    fn grids_too_small_to_cut_are_not_cut() {
        for (columns, rows) in [(8, 8), (2, 2), (3, 10), (1, 1)] {
            assert_eq!(Grid::new(columns, rows), None);
        }
    }
}
