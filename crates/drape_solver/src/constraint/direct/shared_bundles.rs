//! All bundles of one direction, which are independent of each other: threads share columns and rows of patches side by side.
//!
//! ```text
//!   columns   | | | |   thread 1 solves the bundles on the left        rows   =====   thread 1 solves those above
//!             | | | |   of a cut, thread 2 those on the right                 =====   a cut, thread 2 those below
//! ```
//!
//! Design: `docs/design/line_solves.md`.

use core::ops::Range;

use fearless_simd::Simd;

use crate::constants::LEAST_SHARED_CELLS;
use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, solve_chains};
use crate::constraint::direct::chain::Chains;
use crate::constraint::direct::line_storage::Bundling;
use crate::constraint::direct::{rotated_bundle, square_bundle, transposed_bundle};
use crate::constraint::projection::{Exact, Projection, SquareRootFree};
use crate::parallel::workers::Workers;
use crate::simd::cell_columns::CellColumns;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::state::bends::is_at_edge;
use crate::state::settings::StickProjection;

/// The number of threads, of as many as there are, that share a body of so many cells.
pub(super) fn threads(most: usize, cells: usize) -> usize {
    most.min(cells / LEAST_SHARED_CELLS).max(1)
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
            let Self { solve, position, bundles, scratch } = &mut self;
            match solve.bundling {
                Bundling::InPlace { width } => self.columns(simd, bundle, width, projection),
                Bundling::Transposed { width } => {
                    let first = bundle * LANES;
                    let count = LANES.min(solve.grid.rows - first);
                    // The cells of this thread begin with its first bundle.
                    let before = (bundle - bundles.start) * LANES * width;
                    let cells = &mut position.row(0)[before..][..count * width];
                    transposed_bundle::solve(simd, solve, width, first, cells, scratch, projection);
                }
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::direct::bundle::TornBundles;
    use crate::constraint::direct::grid_lines::{ALL_LINES, RuledGrid, Solved};
    use crate::constraint::direct::line_storage::LineStorage;
    use crate::constraint::direct::testing::{crumpled, room_for};
    use crate::simd::isa::Isa;
    use crate::state::membrane::ElasticStick;

    /// Rows that fill bundles and that do not, fewer bundles than threads, sticks and bends.
    #[test]
    #[cfg_attr(miri, ignore = "takes more than eight minutes; `cell_columns` has what Miri looks for")]
    fn any_number_of_threads_leaves_the_same_bits() {
        let columns = 80;
        for rows in [17, 33, 48, 100] {
            let body = crumpled(columns, rows, &[]);
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
                let is_diagonal = lines.is_diagonal();
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
                    let mut scratch = vec![room_for(2 * columns.max(rows) as usize); threads];
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
