//! Sticks of a grid: families of equal sticks, relaxed a vector at a time. Their ends are computed, not stored.
//!
//! Design: `docs/design/memory_layout.md`.

use core::ops::Range;

use crate::simd::columns::LANES;
use crate::state::layout::Grid;

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

    /// The numbers of columns and rows in which sticks of the family begin.
    fn starts(self) -> [usize; 2] {
        let across = self.grid.columns.saturating_sub(self.right.unsigned_abs());
        [across, self.grid.rows.saturating_sub(self.down)]
    }

    /// Places along the split axis that belong to this half: `(number, width of a group)`.
    fn split(self) -> (usize, usize) {
        let [across, down] = self.starts();
        let (places, width) =
            if self.down == 0 { (across, self.right.unsigned_abs()) } else { (down, self.down) };
        let (whole, rest) = (places / (2 * width), places % (2 * width));
        (whole * width + rest.saturating_sub(self.phase * width).min(width), width)
    }

    /// 0 for the sticks that begin at even places, 1 for the others.
    pub fn phase(self) -> usize {
        self.phase
    }

    /// Columns to the right and rows down from one end of a stick to the other.
    pub fn offset(self) -> (isize, usize) {
        (self.right, self.down)
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

    /// The column and row at which stick `k` begins.
    pub fn start(self, k: usize) -> [usize; 2] {
        self.ends(k)[0]
    }

    /// The stick that begins at this column and row, if there is one: the inverse of [`ends`](Self::ends).
    fn stick_from(self, [column, row]: [usize; 2]) -> Option<usize> {
        let left = if self.right < 0 { self.right.unsigned_abs() } else { 0 };
        let ([across, down], (number, width)) = (self.starts(), self.split());
        let column = column.checked_sub(left).filter(|&column| column < across && row < down)?;
        let place = if self.down == 0 { column } else { row };
        let in_group = (place % (2 * width)).checked_sub(self.phase * width).filter(|&i| i < width)?;
        let i = place / (2 * width) * width + in_group;
        Some(if self.down == 0 { row * number + i } else { i * across + column })
    }

    /// The sticks that begin or end at the place with this slot.
    pub fn sticks_at(self, slot: usize) -> impl Iterator<Item = usize> {
        let [column, row] = self.grid.place(slot);
        let before = column.checked_add_signed(-self.right).zip(row.checked_sub(self.down));
        let before = before.map(|(column, row)| [column, row]);
        [Some([column, row]), before].into_iter().flatten().filter_map(move |from| self.stick_from(from))
    }

    /// The stick between two places of the grid, given by their slots, if there is one.
    pub fn stick_between(self, [a, b]: [usize; 2]) -> Option<usize> {
        let [a, b] = [self.grid.place(a), self.grid.place(b)];
        let leads = |from: [usize; 2], to: [usize; 2]| {
            let stick = self.stick_from(from)?;
            (self.ends(stick)[1] == to).then_some(stick)
        };
        leads(a, b).or_else(|| leads(b, a))
    }

    /// The slots of the ends of stick `k`.
    pub fn slots(self, k: usize) -> [usize; 2] {
        self.ends(k).map(|[column, row]| self.grid.slot(column, row))
    }

    /// The two particles that stick `k` joins in a whole grid.
    pub fn particles(self, k: usize) -> [usize; 2] {
        self.ends(k).map(|[column, row]| row * self.grid.columns + column)
    }

    /// The strip of stick `k`, and a run that holds this stick alone.
    fn run_of(self, k: usize) -> (usize, GridRun) {
        let cells_of_strip = self.grid.cells_of_strip();
        let [a, b] = self.slots(k);
        // The lane of the second end is never the lower one, so that there is one direction to shift in.
        let [a, b] = if a % LANES <= b % LANES { [a, b] } else { [b, a] };
        let strip = (a / LANES).min(b / LANES) / cells_of_strip;
        let shift = (b % LANES - a % LANES) as u8;
        let lanes = 1 << (a % LANES);
        let [a, b] = [a, b].map(|slot| (slot / LANES - strip * cells_of_strip) as u32);
        (strip, GridRun { a, b, count: 1, step: 1, shift, lanes })
    }

    /// The `runs` without the `severed` sticks.
    pub fn without(self, runs: &GridRuns, severed: &[u32]) -> GridRuns {
        let mut gone: Vec<(usize, GridRun)> = severed.iter().map(|&k| self.run_of(k as usize)).collect();
        gone.sort_unstable_by_key(|&(strip, run)| (strip, run.a, run.b, run.lanes));
        let strips = self.grid.height.div_ceil(self.grid.cells_of_strip() / self.grid.width);
        let mut of_strips: Vec<&[GridRun]> = vec![&[]; strips];
        for (band, runs) in runs.bands() {
            band.among(&(0..strips)).for_each(|strip| of_strips[strip] = runs);
        }
        let mut left = GridRuns { reach: runs.reach, ..GridRuns::default() };
        for (strip, runs) in of_strips.into_iter().enumerate() {
            let gone = &gone[gone.partition_point(|&(other, _)| other < strip)..];
            let gone = &gone[..gone.partition_point(|&(other, _)| other == strip)];
            if gone.is_empty() {
                left.push(strip as u32, runs);
                continue;
            }
            let mut found = Vec::new();
            for mut cell in runs.iter().flat_map(GridRun::cells) {
                let own = gone.partition_point(|(_, run)| (run.a, run.b) < (cell.a, cell.b));
                let own = gone[own..].iter().take_while(|(_, run)| (run.a, run.b) == (cell.a, cell.b));
                cell.lanes &= !own.fold(0, |bits, (_, run)| bits | run.lanes);
                if cell.lanes != 0 {
                    extend(&mut found, cell);
                }
            }
            left.push(strip as u32, &found);
        }
        left
    }

    /// Collects the sticks into runs of cells, and strips with equal runs into bands. The ascending list `severed`
    /// names the sticks to leave out.
    pub fn runs(self, severed: &[u32]) -> GridRuns {
        let cells_of_strip = self.grid.cells_of_strip();
        // Skip-one sticks along a row begin in two cells of four: every fourth cell makes the longer run.
        let period = if self.down == 0 { 2 * self.right.unsigned_abs() } else { 1 };
        let mut pairs = Vec::with_capacity(self.count());
        let mut severed = severed.iter().peekable();
        for k in 0..self.count() {
            if severed.next_if_eq(&&(k as u32)).is_none() {
                let (strip, GridRun { a, b, shift, lanes, .. }) = self.run_of(k);
                pairs.push((strip, (shift, a as usize % period, a, b), lanes));
            }
        }
        pairs.sort_unstable();
        let mut runs = GridRuns::default();
        for of_strip in pairs.chunk_by(|p, q| p.0 == q.0) {
            let mut found: Vec<GridRun> = Vec::new();
            for same in of_strip.chunk_by(|p, q| p.1 == q.1) {
                let (shift, _, a, b) = same[0].1;
                let lanes = same.iter().fold(0, |bits, pair| bits | pair.2);
                extend(&mut found, GridRun { a, b, count: 1, step: 1, shift, lanes });
                runs.reach = runs.reach.max(a.max(b) as usize / cells_of_strip);
            }
            runs.push(of_strip[0].0 as u32, &found);
        }
        runs
    }
}

/// Cells with the same pattern of sticks: cell `a + k step` is joined to cell `b + k step`, lane `l` to lane `l +
/// shift`. Cells are counted from the first of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GridRun {
    pub a: u32,
    pub b: u32,
    pub count: u32,
    pub step: u32,
    pub shift: u8,
    /// The lanes of `a` that have a stick, lane 0 in the lowest bit.
    pub lanes: u16,
}

impl GridRun {
    /// Its cells, each as a run.
    fn cells(&self) -> impl Iterator<Item = Self> + use<> {
        let run = *self;
        (0..run.count).map(move |k| {
            let [a, b] = [run.a, run.b].map(|cell| cell + k * run.step);
            Self { a, b, count: 1, step: 1, ..run }
        })
    }

    /// The slots of the ends of its sticks in the strip that begins with this cell.
    pub fn slots(&self, first: usize) -> impl Iterator<Item = [usize; 2]> + use<> {
        self.cells().flat_map(move |Self { a, b, shift, lanes, .. }| {
            let [a, b] = [a, b].map(|cell| (first + cell as usize) * LANES);
            let has_stick = move |lane: &usize| lanes & (1 << lane) != 0;
            (0..LANES).filter(has_stick).map(move |lane| [a + lane, b + lane + usize::from(shift)])
        })
    }

    /// Appends `cell` if it continues the run. Returns true if it does.
    fn extend(&mut self, cell: &Self) -> bool {
        let step = if self.count == 1 { cell.a.saturating_sub(self.a) } else { self.step };
        let goes_on = step > 0
            && (self.a + step * self.count, self.b + step * self.count) == (cell.a, cell.b)
            && (self.shift, self.lanes) == (cell.shift, cell.lanes);
        if goes_on {
            (self.step, self.count) = (step, self.count + 1);
        }
        goes_on
    }
}

/// Appends a cell to the last run if it continues that, else as a new run.
fn extend(runs: &mut Vec<GridRun>, cell: GridRun) {
    if !runs.last_mut().is_some_and(|last| last.extend(&cell)) {
        runs.push(cell);
    }
}

/// Strips with equal runs: `first`, `first + step`, ... `count` of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Band {
    first: u32,
    step: u32,
    count: u32,
    /// Start and end of its runs in the list of all.
    runs: [u32; 2],
}

impl Band {
    /// The strips of the band within `strips`.
    #[inline]
    pub fn among(&self, strips: &Range<usize>) -> impl ExactSizeIterator<Item = usize> + Clone + use<> {
        let &Self { first, step, count, .. } = self;
        let place = |strip: usize| (strip as u32).saturating_sub(first).div_ceil(step).min(count);
        (place(strips.start)..place(strips.end)).map(move |k| (first + k * step) as usize)
    }

    /// Appends `strip` if it continues the band. Returns true if it does.
    fn extend(&mut self, strip: u32) -> bool {
        let step = if self.count == 1 { strip - self.first } else { self.step };
        let goes_on = self.first + step * self.count == strip;
        if goes_on {
            (self.step, self.count) = (step, self.count + 1);
        }
        goes_on
    }
}

/// The runs of a batch. Those of a strip reach no strip above.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct GridRuns {
    bands: Vec<Band>,
    runs: Vec<GridRun>,
    /// Greatest number of strips that a run reaches below its own.
    pub reach: usize,
}

impl GridRuns {
    /// Bands of strips, each with the runs of every one of its strips.
    #[inline]
    pub fn bands(&self) -> impl Iterator<Item = (&Band, &[GridRun])> {
        self.bands.iter().map(|band| (band, &self.runs[band.runs[0] as usize..band.runs[1] as usize]))
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.bands) + size_of_val(&*self.runs)
    }

    /// Appends the runs of a strip.
    fn push(&mut self, strip: u32, runs: &[GridRun]) {
        if runs.is_empty() {
            return;
        }
        // With patches of an odd number of rows, strips of two bands alternate.
        for band in self.bands.iter_mut().rev().take(MOST_OPEN_BANDS) {
            let [from, to] = band.runs.map(|place| place as usize);
            if self.runs[from..to] == *runs && band.extend(strip) {
                return;
            }
        }
        let from = self.runs.len() as u32;
        self.runs.extend_from_slice(runs);
        self.bands.push(Band { first: strip, step: 1, count: 1, runs: [from, self.runs.len() as u32] });
    }
}

/// The number of latest bands that a new strip may continue.
const MOST_OPEN_BANDS: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;
    use crate::state::layout::Layout;

    const FAMILIES: [(isize, usize); 6] = [(1, 0), (0, 1), (1, 1), (-1, 1), (2, 0), (0, 2)];

    #[test]
    fn a_family_has_every_stick_once_and_a_half_shares_no_particle() {
        for (columns, rows) in [(16, 16), (48, 1), (61, 13), (5, 49)].into_iter().take(unless_miri(4, 1)) {
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
        for (columns, rows) in [(16, 16), (64, 40), (61, 13), (5, 49)].into_iter().take(unless_miri(4, 1)) {
            let grid = Grid::new(columns, rows).expect("large enough");
            for half in FAMILIES.into_iter().flat_map(|(right, down)| GridBatch::halves(grid, right, down)) {
                let mut found = Vec::new();
                // In two windows, as a sweep down the strips takes them.
                let runs = half.runs(&[]);
                let (_, strips) = Layout::Grid(grid).strips();
                for window in [0..strips / 2, strips / 2..strips] {
                    for (band, runs) in runs.bands() {
                        for (strip, run) in
                            band.among(&window).flat_map(|strip| runs.iter().map(move |run| (strip, run)))
                        {
                            for k in 0..run.count {
                                let lanes = (0..LANES).filter(|lane| run.lanes & (1 << lane) != 0);
                                let first = (strip * grid.cells_of_strip()) as u32 + k * run.step;
                                let [a, b] = [run.a, run.b].map(|cell| (first + cell) as usize * LANES);
                                found.extend(lanes.map(|lane| [a + lane, b + lane + usize::from(run.shift)]));
                            }
                        }
                    }
                }
                let mut expected: Vec<_> = (0..half.count()).map(|k| half.slots(k)).collect();
                for (k, &ends) in expected.iter().enumerate() {
                    assert_eq!(half.stick_between(ends), Some(k));
                    assert_eq!(half.stick_between([ends[1], ends[0]]), Some(k));
                }
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
