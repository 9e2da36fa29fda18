//! Sticks of a grid: whole families of equal sticks, relaxed a vector at a time without their ends being stored.

use crate::columns::LANES;
use crate::layout::Grid;

/// Sticks of one family of a grid that share no particle: from each particle (column, row) to the one at
/// (column + right, row + down).
///
/// Sticks along a row are split by columns, all others by rows, into those that begin at an even place and those that
/// begin at an odd one; skip-one sticks into pairs of places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GridBatch {
    grid: Grid,
    right: isize,
    down: usize,
    /// 0 for the sticks that begin at even places, 1 for the others.
    phase: usize,
}

impl GridBatch {
    /// The two halves of a family, of which one may be empty.
    pub fn halves(grid: Grid, right: isize, down: usize) -> [Self; 2] {
        [0, 1].map(|phase| Self { grid, right, down, phase })
    }

    /// Number of columns and rows from which a stick of the family begins.
    fn starts(self) -> [usize; 2] {
        let across = self.grid.columns.saturating_sub(self.right.unsigned_abs());
        [across, self.grid.rows.saturating_sub(self.down)]
    }

    /// The places along the axis of the split that this half has: `(number, width of a group)`.
    fn split(self) -> (usize, usize) {
        let [across, down] = self.starts();
        let (places, width) =
            if self.down == 0 { (across, self.right.unsigned_abs()) } else { (down, self.down) };
        let (whole, rest) = (places / (2 * width), places % (2 * width));
        (whole * width + rest.saturating_sub(self.phase * width).min(width), width)
    }

    /// Columns to the right and rows down from one end of a stick to the other.
    pub fn offset(self) -> (isize, usize) {
        (self.right, self.down)
    }

    /// How many rows of cells its sticks reach down, where a row of the grid is a row of cells.
    pub fn reach(self) -> usize {
        self.down
    }

    /// The number of sticks.
    pub fn count(self) -> usize {
        let [across, down] = self.starts();
        self.split().0 * if self.down == 0 { down } else { across }
    }

    /// Column and row of the two ends of stick `k`.
    fn ends(self, k: usize) -> [[usize; 2]; 2] {
        let (number, width) = self.split();
        let place = |i: usize| i / width * 2 * width + self.phase * width + i % width;
        let [across, _] = self.starts();
        let (column, row) =
            if self.down == 0 { (place(k % number), k / number) } else { (k % across, place(k / across)) };
        // Sticks that lean to the left begin one column further to the right.
        let from = if self.right < 0 { column + self.right.unsigned_abs() } else { column };
        [[from, row], [from.wrapping_add_signed(self.right), row + self.down]]
    }

    /// The two particles that stick `k` joins.
    pub fn particles(self, k: usize) -> [usize; 2] {
        self.ends(k).map(|[column, row]| row * self.grid.columns + column)
    }

    /// Puts the sticks into runs of cells, row of cells by row of cells.
    pub fn runs(self) -> GridRuns {
        let mut pairs = Vec::with_capacity(self.count());
        for k in 0..self.count() {
            let [a, b] = self.ends(k).map(|[column, row]| self.grid.slot(column, row));
            // The lane of the second end is never the lower one, so that there is one direction to shift in.
            let [a, b] = if a % LANES <= b % LANES { [a, b] } else { [b, a] };
            let row = (a / LANES).min(b / LANES) / self.grid.width;
            pairs.push((row, b % LANES - a % LANES, a / LANES, b / LANES, a % LANES));
        }
        pairs.sort_unstable();
        let mut runs = GridRuns { first_of_row: vec![0], runs: Vec::new() };
        let mut rest = pairs.as_slice();
        for row in 0..self.grid.height {
            while let Some(&(_, shift, a, b, _)) = rest.first().filter(|pair| pair.0 == row) {
                let same = rest.iter().take_while(|p| (p.0, p.1, p.2, p.3) == (row, shift, a, b)).count();
                let lanes = rest[..same].iter().fold(0, |bits, pair| bits | (1 << pair.4));
                let (a, b, shift) = (a as u32, b as u32, shift as u8);
                runs.push(runs.first_of_row[row], GridRun { a, b, count: 1, step: 1, shift, lanes });
                rest = &rest[same..];
            }
            runs.first_of_row.push(runs.runs.len());
        }
        runs
    }
}

/// Cells whose sticks lie alike: cell `a + k step` is joined to cell `b + k step`, lane `l` to lane `l + shift`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GridRun {
    pub a: u32,
    pub b: u32,
    pub count: u32,
    pub step: u16,
    pub shift: u8,
    /// The lanes of `a` that have a stick, lane 0 in the lowest bit.
    pub lanes: u16,
}

/// The runs of a batch, by rows of cells. A run of row `r` reaches no row above.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct GridRuns {
    first_of_row: Vec<usize>,
    runs: Vec<GridRun>,
}

impl GridRuns {
    /// The runs of one row of cells.
    #[inline]
    pub fn of_row(&self, row: usize) -> &[GridRun] {
        &self.runs[self.first_of_row[row]..self.first_of_row[row + 1]]
    }

    /// All runs.
    #[cfg(test)]
    pub fn all(&self) -> &[GridRun] {
        &self.runs
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first_of_row) + size_of_val(&*self.runs)
    }

    /// Adds one cell, as a run of its own or to the last one since `first`.
    fn push(&mut self, first: usize, cell: GridRun) {
        if let Some(last) = self.runs[first..].last_mut() {
            let step = if last.count == 1 { cell.a.wrapping_sub(last.a) } else { u32::from(last.step) };
            let goes_on = (1..=u32::from(u16::MAX)).contains(&step)
                && (last.a + step * last.count, last.b + step * last.count) == (cell.a, cell.b)
                && (last.shift, last.lanes) == (cell.shift, cell.lanes);
            if goes_on {
                last.step = step as u16;
                last.count += 1;
                return;
            }
        }
        self.runs.push(cell);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAMILIES: [(isize, usize); 6] = [(1, 0), (0, 1), (1, 1), (-1, 1), (2, 0), (0, 2)];

    #[test]
    fn a_family_has_every_stick_once_and_a_half_shares_no_particle() {
        for (columns, rows) in [(16, 16), (48, 1), (61, 13), (5, 49)] {
            let grid = Grid::new(columns, rows).expect("large enough");
            for (right, down) in FAMILIES {
                let mut all = Vec::new();
                for half in GridBatch::halves(grid, right, down) {
                    let mut ends: Vec<usize> = (0..half.count()).flat_map(|k| half.particles(k)).collect();
                    all.extend((0..half.count()).map(|k| half.particles(k)));
                    let count = ends.len();
                    ends.sort_unstable();
                    ends.dedup();
                    assert_eq!(ends.len(), count);
                }
                all.sort_unstable();
                let mut expected = Vec::new();
                for (c, r) in (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r))) {
                    let to = c.checked_add_signed(right).filter(|&to| to < columns);
                    if let Some(to) = to.filter(|_| r + down < rows) {
                        expected.push([r * columns + c, (r + down) * columns + to]);
                    }
                }
                expected.sort_unstable();
                assert_eq!(all, expected, "{right} {down} of {columns} x {rows}");
            }
        }
    }

    #[test]
    fn runs_hold_every_stick_once() {
        for (columns, rows) in [(16, 16), (64, 40), (61, 13), (5, 49)] {
            let grid = Grid::new(columns, rows).expect("large enough");
            for half in FAMILIES.into_iter().flat_map(|(right, down)| GridBatch::halves(grid, right, down)) {
                let mut found = Vec::new();
                for run in half.runs().all() {
                    for k in 0..run.count {
                        let lanes = (0..LANES).filter(|lane| run.lanes & (1 << lane) != 0);
                        let [a, b] =
                            [run.a, run.b].map(|cell| (cell + k * u32::from(run.step)) as usize * LANES);
                        found.extend(lanes.map(|lane| [a + lane, b + lane + usize::from(run.shift)]));
                    }
                }
                let slots = |k: usize| half.ends(k).map(|[column, row]| grid.slot(column, row));
                let mut expected: Vec<_> = (0..half.count()).map(slots).collect();
                for pair in found.iter_mut().chain(&mut expected) {
                    pair.sort_unstable();
                }
                found.sort_unstable();
                expected.sort_unstable();
                assert_eq!(found, expected);
            }
        }
    }
}
