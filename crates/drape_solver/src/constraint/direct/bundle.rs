//! Bundles of sixteen lines, which are independent of each other: threads share columns and rows of patches side by side.
//!
//! ```text
//!   columns   | | | |   thread 1 solves the bundles on the left        rows   =====   thread 1 solves those above
//!             | | | |   of a cut, thread 2 those on the right                 =====   a cut, thread 2 those below
//! ```
//!
//! Design: `docs/design/line_solves.md`.

use core::ops::Range;

use fearless_simd::{Simd, prelude::*};

use crate::constants::LEAST_SHARED_CELLS;
use crate::constraint::direct::bent_chain::ChainBend;
use crate::constraint::direct::chain::{ChainScratch, Chains};
use crate::constraint::direct::grid_lines::{Lines, RuledGrid, Solved};
use crate::constraint::direct::line_storage::Bundling;
use crate::constraint::direct::{rotated_bundle, square_bundle};
use crate::constraint::projection::{Exact, Projection, SquareRootFree};
use crate::parallel::workers::Workers;
use crate::simd::cell_columns::{CellColumn, CellColumns};
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::load;
use crate::simd::transpose::transpose;
use crate::state::bends::is_at_edge;
use crate::state::settings::StickProjection;

/// Scratch of one thread for one bundle of lines.
#[derive(Clone, Debug, Default)]
pub(super) struct BundleScratch {
    pub chain: ChainScratch,
    pub bends: Vec<ChainBend>,
    /// The particles of sixteen lines that were brought into the lanes.
    pub position: Vec<Cell>,
    pub inverse_mass: Vec<[f32; LANES]>,
    /// Their weighted sums at rest.
    pub rest: Vec<Cell>,
}

impl BundleScratch {
    /// Makes room for lines that are brought into the lanes.
    pub fn reserve_particles(&mut self, count: usize) {
        grow(&mut self.position, count);
        grow(&mut self.inverse_mass, count);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let Self { chain, bends, position, inverse_mass, rest } = self;
        let cells = size_of_val(&**position) + size_of_val(&**inverse_mass) + size_of_val(&**rest);
        chain.bytes() + size_of_val(&**bends) + cells
    }
}

/// Makes room for `count` values.
pub(super) fn grow<T: Clone + Default>(values: &mut Vec<T>, count: usize) {
    values.resize(count.max(values.len()), T::default());
}

/// The number of threads, of as many as there are, that share a body of so many cells.
pub(super) fn threads(most: usize, cells: usize) -> usize {
    most.min(cells / LEAST_SHARED_CELLS).max(1)
}

/// Gaps and softness of lines, by bundle and place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TornBundles<'a> {
    /// The lanes without a stick to the next place, lane 0 in the lowest bit; none if all have theirs.
    pub gaps: Option<&'a [u16]>,
    /// The compliance of these sticks, in parts of that inside the cloth; none if they are not springs.
    pub softness: Option<&'a [[f32; LANES]]>,
}

impl<'a> TornBundles<'a> {
    /// Those of bundle `bundle`, whose lines have `count` places.
    pub fn of_bundle(self, bundle: usize, count: usize) -> (Option<&'a [u16]>, Option<&'a [[f32; LANES]]>) {
        let own = bundle * count..(bundle + 1) * count;
        (self.gaps.map(|gaps| &gaps[own.clone()]), self.softness.map(|softness| &softness[own]))
    }
}

/// Read by all threads.
#[derive(Clone, Copy)]
pub(super) struct BundleSolve<'a> {
    pub grid: RuledGrid,
    pub inverse_mass: &'a [[f32; LANES]],
    /// Weighted sums of bends at rest, by the middle particle; none where they are zero.
    pub rest: Option<&'a [Cell]>,
    pub torn: TornBundles<'a>,
    pub lines: Lines,
    pub bundling: Bundling,
    pub solved: Solved,
    pub projection: StickProjection,
    pub isa: Isa,
}

impl BundleSolve<'_> {
    /// Solves all lines of this direction on the threads that are free, with the bits that one thread leaves. `scratch` has one
    /// for each thread.
    pub fn solve(&self, position: &mut [Cell], scratch: &mut [BundleScratch], workers: &Workers) {
        let threads = threads(workers.count(), position.len());
        self.solve_on(position, scratch, workers, threads);
    }

    /// As [`solve`](Self::solve), on up to `threads` threads.
    fn solve_on(
        &self,
        position: &mut [Cell],
        scratch: &mut [BundleScratch],
        workers: &Workers,
        threads: usize,
    ) {
        let (number, _) = self.lines.size(self.grid);
        let bundles = self.bundling.bundles(number);
        // All cells side by side: rows are cut between two cells.
        let all = position.len();
        let (width, threads) = match self.bundling {
            Bundling::InPlace { width } => (width, threads),
            Bundling::Transposed { .. } => (all, threads),
            // No cut between two columns or rows of cells parts them.
            Bundling::Rotated { .. } | Bundling::Shuffled(_) => (all, 1),
        };
        let threads = threads.min(bundles).min(scratch.len());
        self.share(CellColumns::new(position, width), 0..bundles, scratch, workers, threads);
    }

    /// Solves `bundles`, which are in these cells, on up to `threads` threads.
    fn share(
        &self,
        mut position: CellColumns,
        bundles: Range<usize>,
        scratch: &mut [BundleScratch],
        workers: &Workers,
        threads: usize,
    ) {
        let Range { start, end } = bundles;
        if threads < 2 {
            if let Some(scratch) = scratch.first_mut() {
                let solve = *self;
                self.isa.run(SomeBundles { solve, position, bundles, scratch });
            }
            return;
        }
        let before = threads / 2;
        let middle = start + (end - start) * before / threads;
        let [mut first, mut second] = position.split_at(match self.bundling {
            Bundling::Transposed { width } => middle * LANES * width,
            _ => middle,
        });
        let (scratch, other) = scratch.split_at_mut(before);
        let after = threads - before;
        let mut one = || self.share(first.reborrow(), start..middle, scratch, workers, before);
        let mut two = || self.share(second.reborrow(), middle..end, other, workers, after);
        workers.join(&mut one, &mut two);
    }
}

/// Some bundles, for one thread.
struct SomeBundles<'a> {
    solve: BundleSolve<'a>,
    position: CellColumns<'a>,
    bundles: Range<usize>,
    scratch: &'a mut BundleScratch,
}

impl Kernel for SomeBundles<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        match self.solve.projection {
            StickProjection::Exact => self.run_with(simd, Exact),
            StickProjection::SquareRootFree => self.run_with(simd, SquareRootFree),
        }
    }
}

impl SomeBundles<'_> {
    #[inline(always)]
    fn run_with<S: Simd>(mut self, simd: S, projection: impl Projection) {
        for bundle in self.bundles.clone() {
            let Self { solve, position, scratch, .. } = &mut self;
            match solve.bundling {
                Bundling::InPlace { width } => self.columns(simd, bundle, width, projection),
                Bundling::Transposed { width } => self.rows(simd, bundle * LANES, width, projection),
                Bundling::Rotated { width } => {
                    rotated_bundle::solve(simd, solve, width, bundle, position.row(0), scratch, projection);
                }
                Bundling::Shuffled(lines) => {
                    square_bundle::solve(simd, solve, lines, bundle, position.row(0), scratch, projection);
                }
            }
        }
    }

    /// Solves one column of all patches, where it lies.
    #[inline(always)]
    fn columns<S: Simd>(&mut self, simd: S, column: usize, width: usize, projection: impl Projection) {
        let BundleSolve { grid, inverse_mass, rest, torn, solved, .. } = self.solve;
        let position = self.position.column(column);
        let count = grid.rows;
        let (gaps, softness) = torn.of_bundle(column, count);
        let chains = Chains { position, inverse_mass, count, gaps, softness };
        let is_edge = |lane| is_at_edge(lane * width + column, grid.columns);
        solve_chains(
            simd,
            chains,
            (&mut self.scratch.chain, &mut self.scratch.bends),
            (solved, rest),
            is_edge,
            projection,
        );
    }

    /// Solves sixteen rows from row `first` on, or those that are left.
    #[inline(always)]
    fn rows<S: Simd>(&mut self, simd: S, first: usize, width: usize, projection: impl Projection) {
        let Self { solve, position, bundles, scratch } = self;
        let &mut BundleSolve { grid, inverse_mass, rest, torn, solved, .. } = solve;
        let count = LANES.min(grid.rows - first);
        // The cells of this thread begin with its first bundle.
        let cells = &mut position.row(0)[(first - bundles.start * LANES) * width..][..count * width];
        let BundleScratch { chain, bends, position, inverse_mass: masses, rest: rests } = &mut **scratch;
        simd.vectorize(
            #[inline(always)]
            || {
                for column in 0..width {
                    let size = [width, count];
                    transpose_vectors(simd, column, size, cells, position);
                    transpose(
                        #[inline(always)]
                        |row| load(simd, &inverse_mass[first * width + cell_of_row(row, column, size)]),
                        #[inline(always)]
                        |patch, of_rows| masses[patch * width + column] = of_rows.to_array(),
                    );
                    if let Some(rest) = rest {
                        transpose_vectors(simd, column, size, &rest[first * width..], rests);
                    }
                }
            },
        );
        let rest = rest.map(|_| &**rests);
        let (gaps, softness) = torn.of_bundle(first / LANES, grid.columns);
        let chains = Chains {
            position: CellColumn::new(position),
            inverse_mass: masses,
            count: grid.columns,
            gaps,
            softness,
        };
        let is_edge = |lane| is_at_edge(first + lane, grid.rows);
        solve_chains(simd, chains, (chain, bends), (solved, rest), is_edge, projection);
        transpose_back(simd, width, cells, position);
    }
}

/// The cell in `column` of the cells of a row, of `count` rows of `width` cells each. Rows that are missing repeat the last one.
#[inline(always)]
fn cell_of_row(row: usize, column: usize, [width, count]: [usize; 2]) -> usize {
    row.min(count - 1) * width + column
}

/// Transposes the vectors of a column of up to sixteen rows of cells into chains side by side.
///
/// Each place in a patch is a cell of every row; after the transposition, each patch is a cell of the chains.
#[inline(always)]
fn transpose_vectors<S: Simd>(simd: S, column: usize, size: [usize; 2], rows: &[Cell], chains: &mut [Cell]) {
    transpose_axis::<S, 0>(simd, column, size, rows, chains);
    transpose_axis::<S, 1>(simd, column, size, rows, chains);
    transpose_axis::<S, 2>(simd, column, size, rows, chains);
}

#[inline(always)]
fn transpose_axis<S: Simd, const AXIS: usize>(
    simd: S,
    column: usize,
    size: [usize; 2],
    rows: &[Cell],
    chains: &mut [Cell],
) {
    transpose(
        #[inline(always)]
        |row| load(simd, rows[cell_of_row(row, column, size)].axes()[AXIS]),
        #[inline(always)]
        |patch, of_rows| *chains[patch * size[0] + column].axes_mut()[AXIS] = of_rows.to_array(),
    );
}

/// Transposes the chains back into rows of `width` cells each: the inverse of [`transpose_vectors`] for all columns.
fn transpose_back<S: Simd>(simd: S, width: usize, rows: &mut [Cell], chains: &[Cell]) {
    simd.vectorize(
        #[inline(always)]
        || {
            for column in 0..width {
                transpose_axis_back::<S, 0>(simd, column, width, rows, chains);
                transpose_axis_back::<S, 1>(simd, column, width, rows, chains);
                transpose_axis_back::<S, 2>(simd, column, width, rows, chains);
            }
        },
    );
}

#[inline(always)]
fn transpose_axis_back<S: Simd, const AXIS: usize>(
    simd: S,
    column: usize,
    width: usize,
    rows: &mut [Cell],
    chains: &[Cell],
) {
    transpose(
        #[inline(always)]
        |patch| load(simd, chains[patch * width + column].axes()[AXIS]),
        #[inline(always)]
        |row, of_patches| {
            if let Some(cell) = rows.get_mut(row * width + column) {
                *cell.axes_mut()[AXIS] = of_patches.to_array();
            }
        },
    );
}

/// Solves chains whose sticks or bends resist alike, but for those of lanes at an edge of the cloth and softer ones. Bends may have a rest.
#[inline(always)]
pub(super) fn solve_chains<S: Simd>(
    simd: S,
    mut chains: Chains,
    (chain, bends): (&mut ChainScratch, &mut [ChainBend]),
    (solved, rest): (Solved, Option<&[Cell]>),
    is_edge: impl Fn(usize) -> bool,
    projection: impl Projection,
) {
    // In torn cloth the softness covers edges, too.
    let is_soft = |lane| chains.softness.is_none() && is_edge(lane);
    let edges = (0..LANES).fold(0, |bits, lane| bits | (u16::from(is_soft(lane)) << lane));
    match solved {
        Solved::Sticks(stick) => chains.solve(simd, chain, stick, edges, projection),
        Solved::Bends(compliance) => chains.bend(simd, bends, compliance, edges, rest),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::constraint::direct::grid_lines::ALL_LINES;
    use crate::constraint::direct::line_storage::LineStorage;
    use crate::constraint::testing::dice;
    use crate::state::membrane::ElasticStick;
    use crate::state::settings::BodySettings;

    /// Rows that fill bundles and that do not, fewer bundles than threads, sticks and bends.
    #[test]
    #[cfg_attr(miri, ignore = "takes more than eight minutes; `cell_columns` has what Miri looks for")]
    fn any_number_of_threads_leaves_the_same_bits() {
        let columns = 80;
        for rows in [17, 33, 48, 100] {
            let cloth = ClothBuilder::new(0.1 * (columns - 1) as f32, 0.1 * (rows - 1) as f32, columns, rows);
            let mut body = cloth.pin(0).build(BodySettings::default()).expect("valid");
            let mut dice = dice(5);
            for i in 0..body.particles.len() {
                let place = body.particles.position(i) + Vec3::new(dice(), dice(), dice()) * 0.02;
                body.particles.set_position(i, place);
            }
            let grid = RuledGrid::of(&body.topology).expect("a grid");
            let patches = grid.patches.expect("in patches");
            assert_eq!(patches.down, 1, "its patches lie side by side");
            let (inverse_mass, _) = body.particles.inverse_mass.as_chunks::<LANES>();
            // Every fifth stick is severed, in a lane that turns.
            let gaps: Vec<u16> =
                (0..columns as usize * 100).map(|i| if i % 5 == 0 { 1 << (i % 16) } else { 0 }).collect();
            let sticks = Solved::Sticks(ElasticStick { rest: 0.1, compliance: 0.0 });
            let bends = Solved::Bends(1.0);
            let cases = [(sticks, false), (sticks, true), (bends, false)];
            for (lines, (solved, has_gaps)) in
                ALL_LINES.into_iter().flat_map(|lines| cases.map(|case| (lines, case)))
            {
                let is_diagonal = matches!(lines, Lines::Diagonals | Lines::Antidiagonals);
                if is_diagonal && matches!(solved, Solved::Bends(_)) {
                    continue;
                }
                let LineStorage::Bundled(bundling) = LineStorage::of(lines, grid) else {
                    panic!("in bundles");
                };
                let solve = BundleSolve {
                    grid,
                    inverse_mass,
                    rest: None,
                    torn: TornBundles { gaps: has_gaps.then_some(&*gaps), softness: None },
                    lines,
                    bundling,
                    solved,
                    projection: StickProjection::Exact,
                    isa: Isa::detected(),
                };
                let solved_on = |threads: usize| {
                    let mut position = body.particles.position.cells.clone();
                    let mut scratch = vec![BundleScratch::default(); threads];
                    for scratch in &mut scratch {
                        let count = 2 * columns.max(rows) as usize;
                        scratch.chain.reserve(count);
                        scratch.reserve_particles(count);
                        grow(&mut scratch.bends, count);
                    }
                    solve.solve_on(&mut position, &mut scratch, &Workers::default(), threads);
                    position
                };
                let alone = solved_on(1);
                assert!(alone != body.particles.position.cells, "{rows} rows: something moves");
                for threads in [2, 3, 8] {
                    assert!(solved_on(threads) == alone, "{rows} rows on {threads} threads");
                }
            }
        }
    }
}
