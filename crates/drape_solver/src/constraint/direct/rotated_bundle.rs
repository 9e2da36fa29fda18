//! Bundles of diagonals, of patches side by side: a place of a bundle is a whole cell, whose lanes are rotated.
//!
//! ```text
//!   patch 0   patch 1   patch 2        The diagonals that begin in column k of all patches go through one cell of each row.
//!   \ . . .   \ . . .   \ . . .        Once in every `width` rows each comes to the next patch, and its particles are one
//!   . \ . .   . \ . .   . \ . .        lane further on.
//! ```
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, prelude::*};

use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, solve_chains};
use crate::constraint::direct::chain::Chains;
use crate::constraint::direct::grid_lines::Lines;
use crate::constraint::projection::Projection;
use crate::simd::cell_columns::CellColumn;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load, rotated};

/// Solves the diagonals of one bundle. `cells` are those of the whole grid.
#[inline(always)]
pub(super) fn solve<S: Simd>(
    simd: S,
    of_body: &BundleSolve,
    width: usize,
    bundle: usize,
    cells: &mut [Cell],
    scratch: &mut BundleScratch,
    projection: impl Projection,
) {
    let &BundleSolve { grid, lines, inverse_mass, torn, solved, .. } = of_body;
    let count = grid.rows;
    // The column of the diagonal that begins in patch 0, counted around the grid, for each row.
    let cell_and_rotation = |row: usize| {
        let around = LANES * width;
        let column = match lines {
            Lines::Antidiagonals => bundle + around - row % around,
            _ => bundle + row,
        };
        (row * width + column % width, column / width % LANES)
    };
    let BundleScratch { chain, bends, position, inverse_mass: masses, .. } = scratch;
    simd.vectorize(
        #[inline(always)]
        || {
            for (row, (place, mass)) in position[..count].iter_mut().zip(masses.iter_mut()).enumerate() {
                let (cell, rotation) = cell_and_rotation(row);
                Lanes3::load(simd, &cells[cell]).rotated(rotation).store(place);
                *mass = rotated(load(simd, &inverse_mass[cell]), rotation).to_array();
            }
        },
    );
    let (gaps, softness) = torn.of_bundle(bundle, count);
    let chains = Chains { position: CellColumn::new(position), inverse_mass: masses, count, gaps, softness };
    // A diagonal belongs to one square alone, so that none is at an edge.
    solve_chains(simd, chains, (chain, bends), (solved, None), |_| false, projection);
    simd.vectorize(
        #[inline(always)]
        || {
            for (row, place) in position[..count].iter().enumerate() {
                let (cell, rotation) = cell_and_rotation(row);
                Lanes3::load(simd, place).rotated(LANES - rotation).store(&mut cells[cell]);
            }
        },
    );
}
