//! Bundles of rows of patches side by side: sixteen rows at a time are transposed into the lanes.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, prelude::*};

use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, solve_chains};
use crate::constraint::direct::chain::Chains;
use crate::constraint::projection::Projection;
use crate::simd::cell_columns::CellColumn;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::load;
use crate::simd::transpose::transpose;
use crate::state::bends::is_at_edge;

/// Solves the sixteen rows from row `first` on, or those that are left. `cells` are theirs alone.
#[inline(always)]
pub(super) fn solve<S: Simd>(
    simd: S,
    of_body: &BundleSolve,
    width: usize,
    first: usize,
    cells: &mut [Cell],
    scratch: &mut BundleScratch,
    projection: impl Projection,
) {
    let &BundleSolve { grid, inverse_mass, rest, torn, solved, .. } = of_body;
    let count = cells.len() / width;
    let BundleScratch { chain, bends, position, inverse_mass: masses, rest: rests } = scratch;
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
