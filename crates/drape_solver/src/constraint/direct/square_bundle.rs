//! Bundles of rows or columns of small grids, whose patches lie four by four: [four neighbouring lines](SquareLines) of every patch,
//! which a shuffle brings into the lanes.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, solve_chains};
use crate::constraint::direct::chain::Chains;
use crate::constraint::direct::line_storage::SquareLines;
use crate::constraint::projection::Projection;
use crate::simd::cell_columns::CellColumn;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::load;
use crate::simd::transpose::{shuffle_four, unshuffle_four};
use crate::state::bends::is_at_edge;

impl SquareLines {
    /// Brings numbers of a bundle into the lanes. Spare lanes repeat the last line. `from` has the columns of numbers of a cell, `to`
    /// takes a cell of the chains, the index of a column and its numbers.
    #[inline(always)]
    fn shuffle<'a, S: Simd, const N: usize>(
        self,
        simd: S,
        bundle: usize,
        from: impl Fn(usize) -> [&'a [f32; LANES]; N],
        mut to: impl FnMut(usize, usize, [f32; LANES]),
    ) {
        let last = self.lines_of(bundle) - 1;
        for place in 0..self.places {
            let [a, b, c, d] = [0, 1, 2, 3].map(|line| self.cell(bundle, last.min(line), place));
            for axis in 0..N {
                let lines = [
                    load(simd, from(a)[axis]),
                    load(simd, from(b)[axis]),
                    load(simd, from(c)[axis]),
                    load(simd, from(d)[axis]),
                ];
                let [a, b, c, d] = if self.are_columns {
                    shuffle_four(shuffle_four(lines))
                } else {
                    unshuffle_four(unshuffle_four(lines))
                };
                to(place, axis, a.to_array());
                to(self.places + place, axis, b.to_array());
                to(2 * self.places + place, axis, c.to_array());
                to(3 * self.places + place, axis, d.to_array());
            }
        }
    }

    /// Brings the positions of a bundle's chains back into `cells`: the inverse of [`shuffle`](Self::shuffle).
    #[inline(always)]
    fn shuffle_back<S: Simd>(self, simd: S, bundle: usize, cells: &mut [Cell], position: &[Cell]) {
        let count = self.lines_of(bundle);
        for place in 0..self.places {
            for axis in 0..3 {
                let from = |patch: usize| load(simd, position[patch * self.places + place].axes()[axis]);
                let patches = [from(0), from(1), from(2), from(3)];
                let [a, b, c, d] = if self.are_columns {
                    unshuffle_four(unshuffle_four(patches))
                } else {
                    shuffle_four(shuffle_four(patches))
                };
                let mut to = |line: usize, numbers: f32x16<S>| {
                    if line < count {
                        *cells[self.cell(bundle, line, place)].axes_mut()[axis] = numbers.to_array();
                    }
                };
                to(0, a);
                to(1, b);
                to(2, c);
                to(3, d);
            }
        }
    }
}

/// Solves the lines of one bundle. `cells` are those of the whole grid.
#[inline(always)]
pub(super) fn solve<S: Simd>(
    simd: S,
    of_body: &BundleSolve,
    square: SquareLines,
    bundle: usize,
    cells: &mut [Cell],
    scratch: &mut BundleScratch,
    projection: impl Projection,
) {
    let &BundleSolve { grid, lines, inverse_mass, rest, torn, solved, .. } = of_body;
    let (number, count) = lines.size(grid);
    let BundleScratch { chain, bends, position, inverse_mass: masses, rest: rests } = scratch;
    simd.vectorize(
        #[inline(always)]
        || {
            square.shuffle(
                simd,
                bundle,
                #[inline(always)]
                |cell| cells[cell].axes(),
                #[inline(always)]
                |cell, axis, numbers| *position[cell].axes_mut()[axis] = numbers,
            );
            square.shuffle(
                simd,
                bundle,
                #[inline(always)]
                |cell| [&inverse_mass[cell]],
                #[inline(always)]
                |cell, _, numbers| masses[cell] = numbers,
            );
        },
    );
    let rest = rest.map(|rest| {
        square.shuffle(
            simd,
            bundle,
            #[inline(always)]
            |cell| rest[cell].axes(),
            #[inline(always)]
            |cell, axis, numbers| *rests[cell].axes_mut()[axis] = numbers,
        );
        &**rests
    });
    let (gaps, softness) = torn.of_bundle(bundle, count);
    let chains = Chains { position: CellColumn::new(position), inverse_mass: masses, count, gaps, softness };
    let is_edge = |lane| is_at_edge(square.line_of(bundle, lane), number);
    solve_chains(simd, chains, (chain, bends), (solved, rest), is_edge, projection);
    simd.vectorize(
        #[inline(always)]
        || square.shuffle_back(simd, bundle, cells, position),
    );
}
