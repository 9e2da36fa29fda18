//! Bundles of rows or columns of small grids, whose patches lie four by four: [four neighbouring lines](SquareLines) of every patch,
//! which a shuffle brings into the lanes.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, solve_chains};
use crate::constraint::direct::chain::Chains;
use crate::constraint::direct::line_storage::{SIDE, SquareLines};
use crate::constraint::projection::Projection;
use crate::simd::cell_columns::CellColumn;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load};
use crate::simd::transpose::{shuffle_four, unshuffle_four};
use crate::state::bends::is_at_edge;

impl SquareLines {
    /// The cells of the four lines of a bundle at one place. Lines that are missing repeat the last one.
    #[inline(always)]
    fn cells(self, bundle: usize, place: usize) -> [usize; SIDE] {
        let last = self.lines_of(bundle) - 1;
        [0, 1, 2, 3].map(|line| self.cell(bundle, last.min(line), place))
    }

    /// Numbers of four lines at one place of all patches, as those of the chains: one vector for each patch along the lines.
    #[inline(always)]
    fn to_chains<S: Simd>(self, lines: [f32x16<S>; SIDE]) -> [f32x16<S>; SIDE] {
        if self.are_columns {
            shuffle_four(shuffle_four(lines))
        } else {
            unshuffle_four(unshuffle_four(lines))
        }
    }

    /// The inverse of [`to_chains`](Self::to_chains).
    #[inline(always)]
    fn to_lines<S: Simd>(self, chains: [f32x16<S>; SIDE]) -> [f32x16<S>; SIDE] {
        if self.are_columns {
            unshuffle_four(unshuffle_four(chains))
        } else {
            shuffle_four(shuffle_four(chains))
        }
    }

    /// Brings the inverse masses of a bundle into the lanes of its chains. Lines that are missing do not move.
    #[inline(always)]
    fn gather_masses<S: Simd>(self, simd: S, bundle: usize, from: &[[f32; LANES]], to: &mut [[f32; LANES]]) {
        const NONE: [f32; LANES] = [0.0; LANES];
        let lines = self.lines_of(bundle);
        for place in 0..self.places {
            let [a, b, c, d] = self.cells(bundle, place);
            let b = if lines < 2 { &NONE } else { &from[b] };
            let c = if lines < 3 { &NONE } else { &from[c] };
            let d = if lines < 4 { &NONE } else { &from[d] };
            let lines = [load(simd, &from[a]), load(simd, b), load(simd, c), load(simd, d)];
            let [a, b, c, d] = self.to_chains(lines);
            to[place] = a.to_array();
            to[self.places + place] = b.to_array();
            to[2 * self.places + place] = c.to_array();
            to[3 * self.places + place] = d.to_array();
        }
    }

    /// Brings the vectors of a bundle into the lanes of its chains.
    #[inline(always)]
    fn gather3<S: Simd>(self, simd: S, bundle: usize, from: &[Cell], to: &mut [Cell]) {
        for place in 0..self.places {
            let [a, b, c, d] = self.cells(bundle, place);
            let (a, b) = (Lanes3::load(simd, &from[a]), Lanes3::load(simd, &from[b]));
            let (c, d) = (Lanes3::load(simd, &from[c]), Lanes3::load(simd, &from[d]));
            let x = self.to_chains([a.x, b.x, c.x, d.x]);
            let y = self.to_chains([a.y, b.y, c.y, d.y]);
            let z = self.to_chains([a.z, b.z, c.z, d.z]);
            Lanes3 { x: x[0], y: y[0], z: z[0] }.store(&mut to[place]);
            Lanes3 { x: x[1], y: y[1], z: z[1] }.store(&mut to[self.places + place]);
            Lanes3 { x: x[2], y: y[2], z: z[2] }.store(&mut to[2 * self.places + place]);
            Lanes3 { x: x[3], y: y[3], z: z[3] }.store(&mut to[3 * self.places + place]);
        }
    }

    /// Brings the vectors of a bundle's chains back into `cells`: the inverse of [`gather3`](Self::gather3).
    #[inline(always)]
    fn scatter3<S: Simd>(self, simd: S, bundle: usize, cells: &mut [Cell], chains: &[Cell]) {
        for place in 0..self.places {
            let [a, b, c, d] = [0, 1, 2, 3].map(|patch| patch * self.places + place);
            let (a, b) = (Lanes3::load(simd, &chains[a]), Lanes3::load(simd, &chains[b]));
            let (c, d) = (Lanes3::load(simd, &chains[c]), Lanes3::load(simd, &chains[d]));
            let x = self.to_lines([a.x, b.x, c.x, d.x]);
            let y = self.to_lines([a.y, b.y, c.y, d.y]);
            let z = self.to_lines([a.z, b.z, c.z, d.z]);
            let [first, second, third, fourth] = self.cells(bundle, place);
            // Lines that are missing come first, so that the last one overwrites them.
            Lanes3 { x: x[3], y: y[3], z: z[3] }.store(&mut cells[fourth]);
            Lanes3 { x: x[2], y: y[2], z: z[2] }.store(&mut cells[third]);
            Lanes3 { x: x[1], y: y[1], z: z[1] }.store(&mut cells[second]);
            Lanes3 { x: x[0], y: y[0], z: z[0] }.store(&mut cells[first]);
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
            square.gather3(simd, bundle, cells, position);
            square.gather_masses(simd, bundle, inverse_mass, masses);
            if let Some(rest) = rest {
                square.gather3(simd, bundle, rest, rests);
            }
        },
    );
    let rest = rest.map(|_| &**rests);
    let (gaps, softness) = torn.of_bundle(bundle, count);
    let chains = Chains { position: CellColumn::new(position), inverse_mass: masses, count, gaps, softness };
    let is_edge = |lane| is_at_edge(square.line_of(bundle, lane), number);
    solve_chains(simd, chains, (chain, bends), (solved, rest), is_edge, projection);
    simd.vectorize(
        #[inline(always)]
        || square.scatter3(simd, bundle, cells, position),
    );
}
