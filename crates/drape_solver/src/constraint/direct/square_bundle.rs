//! Bundles of small grids, whose patches lie four by four: four neighbouring lines in every patch.
//!
//! ```text
//!   columns k .. k + 3 of all patches         the four cells of a place of these columns, shuffled:
//!     | 0 | 1 | 2 | 3 |                         cell b has this place of patches 4 b .. 4 b + 3,
//!     | 4 | 5 | 6 | 7 |                         so that chains go on from patch to patch;
//!     | 8 | . | . | . |                         lane 4 a + i has column k + i of patch column a
//! ```
//!
//! Rows are alike: lane 4 i + b has row k + i of patch row b.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, Direction, solve_chains};
use crate::constraint::direct::chain::Chains;
use crate::constraint::projection::Projection;
use crate::simd::cell_columns::CellColumn;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::load;
use crate::simd::transpose::{shuffle_four, unshuffle_four};
use crate::state::bends::is_at_edge;
use crate::state::layout::Grid;

/// The number of patches in a row or a column of them, and of lines of each patch in a bundle.
pub(super) const SIDE: usize = 4;

/// The lines of one direction of patches four by four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SquareLines {
    direction: Direction,
    /// The number of lines in a patch, and of places in each.
    size: [usize; 2],
    /// The number of cells from a line to the next, and from a place to the next.
    step: [usize; 2],
}

impl SquareLines {
    pub fn new(direction: Direction, Grid { width, height, .. }: Grid) -> Self {
        match direction {
            Direction::Columns => Self { direction, size: [width, height], step: [1, width] },
            Direction::Rows => Self { direction, size: [height, width], step: [width, 1] },
        }
    }

    /// The number of bundles.
    pub fn bundles(self) -> usize {
        self.size[0].div_ceil(SIDE)
    }

    /// The bundle of a line of the grid, and its lane.
    pub fn bundle_of(self, line: usize) -> (usize, usize) {
        let (patch, in_patch) = (line / self.size[0], line % self.size[0]);
        let lane = match self.direction {
            Direction::Columns => patch * SIDE + in_patch % SIDE,
            Direction::Rows => in_patch % SIDE * SIDE + patch,
        };
        (in_patch / SIDE, lane)
    }

    /// The line in a lane of a bundle: the inverse of [`bundle_of`](Self::bundle_of). Lanes that are spare get a line of another bundle.
    fn line_of(self, bundle: usize, lane: usize) -> usize {
        let (patch, in_bundle) = match self.direction {
            Direction::Columns => (lane / SIDE, lane % SIDE),
            Direction::Rows => (lane % SIDE, lane / SIDE),
        };
        patch * self.size[0] + bundle * SIDE + in_bundle
    }

    /// The lines in each patch that belong to a bundle: four, but for the last bundle.
    fn lines_of(self, bundle: usize) -> usize {
        SIDE.min(self.size[0] - bundle * SIDE)
    }

    /// The cell of a place of line `line` of a bundle.
    #[inline(always)]
    fn cell(self, bundle: usize, line: usize, place: usize) -> usize {
        (bundle * SIDE + line) * self.step[0] + place * self.step[1]
    }

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
        for place in 0..self.size[1] {
            let [a, b, c, d] = [0, 1, 2, 3].map(|line| self.cell(bundle, last.min(line), place));
            for axis in 0..N {
                let lines = [
                    load(simd, from(a)[axis]),
                    load(simd, from(b)[axis]),
                    load(simd, from(c)[axis]),
                    load(simd, from(d)[axis]),
                ];
                let [a, b, c, d] = match self.direction {
                    Direction::Columns => shuffle_four(shuffle_four(lines)),
                    Direction::Rows => unshuffle_four(unshuffle_four(lines)),
                };
                to(place, axis, a.to_array());
                to(self.size[1] + place, axis, b.to_array());
                to(2 * self.size[1] + place, axis, c.to_array());
                to(3 * self.size[1] + place, axis, d.to_array());
            }
        }
    }

    /// Brings the positions of a bundle's chains back into `cells`: the inverse of [`shuffle`](Self::shuffle).
    #[inline(always)]
    fn shuffle_back<S: Simd>(self, simd: S, bundle: usize, cells: &mut [Cell], position: &[Cell]) {
        let count = self.lines_of(bundle);
        for place in 0..self.size[1] {
            for axis in 0..3 {
                let from = |patch: usize| load(simd, position[patch * self.size[1] + place].axes()[axis]);
                let patches = [from(0), from(1), from(2), from(3)];
                let [a, b, c, d] = match self.direction {
                    Direction::Columns => unshuffle_four(unshuffle_four(patches)),
                    Direction::Rows => shuffle_four(shuffle_four(patches)),
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
    bundle: usize,
    cells: &mut [Cell],
    scratch: &mut BundleScratch,
    projection: impl Projection,
) {
    let &BundleSolve { grid, patches, inverse_mass, rest, torn, direction, solved, .. } = of_body;
    let lines = SquareLines::new(direction, patches);
    let (number, count) = match direction {
        Direction::Columns => (grid.columns, grid.rows),
        Direction::Rows => (grid.rows, grid.columns),
    };
    let BundleScratch { chain, bends, position, inverse_mass: masses, rest: rests } = scratch;
    simd.vectorize(
        #[inline(always)]
        || {
            lines.shuffle(
                simd,
                bundle,
                #[inline(always)]
                |cell| cells[cell].axes(),
                #[inline(always)]
                |cell, axis, numbers| *position[cell].axes_mut()[axis] = numbers,
            );
            lines.shuffle(
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
        lines.shuffle(
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
    let is_edge = |lane| is_at_edge(lines.line_of(bundle, lane), number);
    solve_chains(simd, chains, (chain, bends), (solved, rest), is_edge, projection);
    simd.vectorize(
        #[inline(always)]
        || lines.shuffle_back(simd, bundle, cells, position),
    );
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::constraint::direct::bundle::{TornBundles, grow};
    use crate::constraint::direct::grid_lines::{RuledGrid, Solved};
    use crate::constraint::projection::Exact;
    use crate::constraint::testing::dice;
    use crate::parallel::workers::Workers;
    use crate::simd::isa::{Isa, Kernel};
    use crate::state::membrane::ElasticStick;
    use crate::state::settings::{BodySettings, StickProjection};

    /// One line in all sixteen lanes.
    struct OneLine<'a> {
        position: Vec<Cell>,
        inverse_mass: Vec<[f32; LANES]>,
        rest: Option<Vec<Cell>>,
        gaps: Option<Vec<u16>>,
        solved: Solved,
        is_edge: bool,
        scratch: &'a mut BundleScratch,
    }

    impl Kernel for OneLine<'_> {
        type Output = Vec<Cell>;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Vec<Cell> {
            let Self { mut position, inverse_mass, rest, gaps, solved, is_edge, scratch } = self;
            let chains = Chains {
                count: position.len(),
                position: CellColumn::new(&mut position),
                inverse_mass: &inverse_mass,
                gaps: gaps.as_deref(),
                softness: None,
            };
            let BundleScratch { chain, bends, .. } = scratch;
            solve_chains(simd, chains, (chain, bends), (solved, rest.as_deref()), |_| is_edge, Exact);
            position
        }
    }

    fn splat(v: Vec3) -> Cell {
        Cell { x: [v.x; LANES], y: [v.y; LANES], z: [v.z; LANES] }
    }

    /// True if a line has no stick from this place to the next.
    fn is_gap(line: usize, place: usize) -> bool {
        (7 * line + place).is_multiple_of(5)
    }

    /// Grids with and without ghosts, and patches of three to eight lines.
    #[test]
    fn each_line_moves_as_it_does_alone() {
        let sticks = |compliance| Solved::Sticks(ElasticStick { rest: 0.1, compliance });
        let cases =
            [(sticks(0.0), false), (sticks(0.0), true), (sticks(5.0), false), (Solved::Bends(1.0), false)];
        for (columns, rows) in [(9, 12), (17, 30), (32, 31), (24, 40)] {
            let cloth = ClothBuilder::new(0.1 * (columns - 1) as f32, 0.1 * (rows - 1) as f32, columns, rows);
            let mut body = cloth.pin(0).pin(40).build(BodySettings::default()).expect("valid");
            let mut dice = dice(3);
            for i in 0..body.particles.len() {
                let place = body.particles.position(i) + Vec3::new(dice(), dice(), dice()) * 0.02;
                body.particles.set_position(i, place);
            }
            body.particles.arrange(&body.topology.layout);
            let grid = RuledGrid::of(&body.topology).expect("a grid");
            let patches = grid.patches.expect("in patches");
            assert_eq!([patches.across, patches.down], [SIDE; 2], "{columns} x {rows}");
            let (inverse_mass, _) = body.particles.inverse_mass.as_chunks::<LANES>();
            let rest: Vec<Cell> =
                body.particles.position.cells.iter().map(|cell| splat(cell.get(3) * 0.01)).collect();
            let mut scratch = BundleScratch::default();
            scratch.chain.reserve(64);
            scratch.reserve_particles(64);
            grow(&mut scratch.bends, 64);
            grow(&mut scratch.rest, 64);
            for (direction, (solved, has_gaps)) in [Direction::Columns, Direction::Rows]
                .into_iter()
                .flat_map(|direction| cases.map(|case| (direction, case)))
            {
                let lines = SquareLines::new(direction, patches);
                let (number, count) = match direction {
                    Direction::Columns => (grid.columns, grid.rows),
                    Direction::Rows => (grid.rows, grid.columns),
                };
                let mut gaps = vec![0; lines.bundles() * count];
                for (line, place) in (0..number).flat_map(|line| (0..count).map(move |place| (line, place))) {
                    let (bundle, lane) = lines.bundle_of(line);
                    assert_eq!(lines.line_of(bundle, lane), line);
                    gaps[bundle * count + place] |= u16::from(is_gap(line, place)) << lane;
                }
                let rest = matches!(solved, Solved::Bends(_)).then_some(&*rest);
                let mut position = body.particles.position.cells.clone();
                let solve = BundleSolve {
                    grid,
                    patches,
                    inverse_mass,
                    rest,
                    torn: TornBundles { gaps: has_gaps.then_some(&*gaps), softness: None },
                    direction,
                    solved,
                    projection: StickProjection::Exact,
                    isa: Isa::detected(),
                };
                solve.solve(&mut position, core::slice::from_mut(&mut scratch), &Workers::default());
                for line in 0..number {
                    let slots = (0..count).map(|place| match direction {
                        Direction::Columns => patches.slot(line, place),
                        Direction::Rows => patches.slot(place, line),
                    });
                    let ends: Vec<(usize, usize)> = slots.map(|slot| (slot / LANES, slot % LANES)).collect();
                    let of = |cells: &[Cell]| {
                        ends.iter().map(|&(cell, lane)| splat(cells[cell].get(lane))).collect()
                    };
                    let alone = Isa::detected().run(OneLine {
                        position: of(&body.particles.position.cells),
                        inverse_mass: ends
                            .iter()
                            .map(|&(cell, lane)| [inverse_mass[cell][lane]; LANES])
                            .collect(),
                        rest: rest.map(of),
                        gaps: has_gaps.then(|| {
                            (0..count).map(|place| if is_gap(line, place) { u16::MAX } else { 0 }).collect()
                        }),
                        solved,
                        is_edge: is_at_edge(line, number),
                        scratch: &mut scratch,
                    });
                    for (&(cell, lane), alone) in ends.iter().zip(&alone) {
                        assert_eq!(
                            position[cell].get(lane),
                            alone.get(0),
                            "{columns} x {rows}, {direction:?} {line}, {solved:?}, gaps: {has_gaps}"
                        );
                    }
                }
            }
        }
    }
}
