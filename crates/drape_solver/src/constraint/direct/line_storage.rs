//! The way that the lines of a grid come into the lanes of a [line solve](crate::constraint::direct::line).
//!
//! Design: `docs/design/line_solves.md`.

use crate::constraint::direct::grid_lines::{Lines, RuledGrid};
use crate::simd::columns::LANES;
use crate::state::layout::{Grid, Layout};

/// The way that lines come into the lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LineStorage {
    /// In bundles, by whole cells.
    Bundled(Bundling),
    /// Sixteen at a time, particle by particle.
    Gathered,
    /// Solved one by one, because there are too few of them.
    Lone,
}

/// The way that whole cells become a bundle of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bundling {
    /// Columns of patches side by side: bundle `k` is column `k` of all patches, which is in the lanes already.
    InPlace { width: usize },
    /// Rows of patches side by side: bundle `k` is the rows from `16 k` on, which must be transposed into the lanes.
    Transposed { width: usize },
    /// Diagonals of patches side by side: bundle `k` begins in column `k` of all patches, and changes lanes where it comes to the
    /// next patch.
    Rotated { width: usize },
    /// Rows or columns of patches four by four.
    Shuffled(SquareLines),
}

/// Least number of lines that are solved side by side.
const LEAST_BUNDLED_LINES: usize = 4;

impl LineStorage {
    pub fn of(lines: Lines, grid: RuledGrid) -> Self {
        match (lines, grid.patches) {
            _ if !lines.is_diagonal() && lines.size(grid).0 < LEAST_BUNDLED_LINES => Self::Lone,
            (Lines::Rows, Some(Grid { down: 1, width, .. })) => Self::Bundled(Bundling::Transposed { width }),
            (Lines::Columns, Some(Grid { down: 1, width, .. })) => Self::Bundled(Bundling::InPlace { width }),
            (_, Some(Grid { down: 1, width, .. })) => Self::Bundled(Bundling::Rotated { width }),
            (_, Some(patches @ Grid { across: SIDE, down: SIDE, .. })) if !lines.is_diagonal() => {
                Self::Bundled(Bundling::Shuffled(SquareLines::new(lines, patches)))
            }
            _ => Self::Gathered,
        }
    }

    /// The number of places of lines of `count` particles, with the ghosts behind them that come along in whole cells.
    pub fn places(self, count: usize) -> usize {
        match self {
            Self::Bundled(Bundling::Transposed { width }) => LANES * width,
            Self::Bundled(Bundling::Shuffled(lines)) => SIDE * lines.places,
            _ => count,
        }
    }

    /// The number of bundles for `number` lines.
    pub fn bundles(self, number: usize) -> usize {
        match self {
            Self::Bundled(bundling) => bundling.bundles(number),
            Self::Gathered | Self::Lone => number.div_ceil(LANES),
        }
    }

    /// The bundle in which a line is solved, and its lane.
    pub fn bundle_of(self, line: usize) -> (usize, usize) {
        match self {
            Self::Bundled(Bundling::InPlace { width } | Bundling::Rotated { width }) => {
                (line % width, line / width)
            }
            Self::Bundled(Bundling::Shuffled(lines)) => lines.bundle_of(line),
            Self::Bundled(Bundling::Transposed { .. }) | Self::Gathered | Self::Lone => {
                (line / LANES, line % LANES)
            }
        }
    }
}

impl Bundling {
    /// The number of bundles for `number` lines.
    pub fn bundles(self, number: usize) -> usize {
        match self {
            Self::InPlace { width } | Self::Rotated { width } => width,
            Self::Transposed { .. } => number.div_ceil(LANES),
            Self::Shuffled(lines) => lines.bundles(),
        }
    }
}

/// The number of patches in a row or a column of patches four by four, and of lines of each patch in a bundle.
pub(super) const SIDE: usize = 4;

/// The rows or columns of patches four by four.
///
/// ```text
///   columns k .. k + 3 of all patches         the four cells of a place of these columns, shuffled:
///     | 0 | 1 | 2 | 3 |                         cell b has this place of patches 4 b .. 4 b + 3,
///     | 4 | 5 | 6 | 7 |                         so that chains go on from patch to patch;
///     | 8 | . | . | . |                         lane 4 a + i has column k + i of patch column a
/// ```
///
/// Rows likewise: lane 4 i + b has row k + i of patch row b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SquareLines {
    pub are_columns: bool,
    /// The number of lines in a patch.
    lines: usize,
    /// The number of places of a line in a patch.
    pub places: usize,
    /// The number of cells from a line to the next, and from a place to the next.
    step: [usize; 2],
}

impl SquareLines {
    pub fn new(lines: Lines, Grid { width, height, .. }: Grid) -> Self {
        match lines {
            Lines::Columns => Self { are_columns: true, lines: width, places: height, step: [1, width] },
            _ => Self { are_columns: false, lines: height, places: width, step: [width, 1] },
        }
    }

    /// The number of bundles.
    pub fn bundles(self) -> usize {
        self.lines.div_ceil(SIDE)
    }

    /// The bundle of a line of the grid, and its lane.
    pub fn bundle_of(self, line: usize) -> (usize, usize) {
        let (patch, in_patch) = (line / self.lines, line % self.lines);
        let in_bundle = in_patch % SIDE;
        let lane = if self.are_columns { patch * SIDE + in_bundle } else { in_bundle * SIDE + patch };
        (in_patch / SIDE, lane)
    }

    /// The line in a lane of a bundle: the inverse of [`bundle_of`](Self::bundle_of). Spare lanes get a line of another bundle.
    pub fn line_of(self, bundle: usize, lane: usize) -> usize {
        let (high, low) = (lane / SIDE, lane % SIDE);
        let (patch, in_bundle) = if self.are_columns { (high, low) } else { (low, high) };
        patch * self.lines + bundle * SIDE + in_bundle
    }

    /// The number of lines in each patch that belong to a bundle: four, but for the last bundle.
    pub fn lines_of(self, bundle: usize) -> usize {
        SIDE.min(self.lines - bundle * SIDE)
    }

    /// The cell of a place of line `line` of a bundle.
    #[inline(always)]
    pub fn cell(self, bundle: usize, line: usize, place: usize) -> usize {
        (bundle * SIDE + line) * self.step[0] + place * self.step[1]
    }
}

/// The slots of the particles of all lines that must be gathered.
pub(super) fn slots(layout: &Layout, grid: RuledGrid, lines: Lines) -> Vec<u32> {
    let lanes = match LineStorage::of(lines, grid) {
        LineStorage::Gathered => LANES,
        LineStorage::Lone => 1,
        LineStorage::Bundled(_) => return Vec::new(),
    };
    let slot = |[column, row]: [usize; 2]| match grid.patches {
        Some(patches) => patches.slot(column, row) as u32,
        None => layout.slot(row * grid.columns + column) as u32,
    };
    let (number, count) = lines.size(grid);
    let mut slots = Vec::with_capacity(number * count);
    for first in (0..number).step_by(lanes) {
        let places =
            (0..count).flat_map(|place| (first..number.min(first + lanes)).map(move |line| [line, place]));
        slots.extend(places.map(|at| slot(lines.column_and_row(grid, at))));
    }
    slots
}

#[cfg(test)]
mod tests {
    use fearless_simd::Simd;
    use glam::Vec3;

    use super::*;
    use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, TornBundles, solve_chains};
    use crate::constraint::direct::chain::Chains;
    use crate::constraint::direct::grid_lines::{ALL_LINES, Solved};
    use crate::constraint::direct::testing::{crumpled, room_for};
    use crate::constraint::projection::Exact;
    use crate::constraint::testing::dice;
    use crate::parallel::workers::Workers;
    use crate::simd::cell_columns::CellColumn;
    use crate::simd::columns::Cell;
    use crate::simd::isa::{Isa, Kernel};
    use crate::state::bends::is_at_edge;
    use crate::state::membrane::ElasticStick;
    use crate::state::settings::StickProjection;

    /// One line in all sixteen lanes.
    struct OneLine<'a> {
        position: Vec<Cell>,
        inverse_mass: Vec<[f32; LANES]>,
        rest: Option<Vec<Cell>>,
        gaps: Option<Vec<u16>>,
        softness: Option<Vec<[f32; LANES]>>,
        solved: Solved,
        is_edge: bool,
        scratch: &'a mut BundleScratch,
    }

    impl Kernel for OneLine<'_> {
        type Output = Vec<Cell>;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Vec<Cell> {
            let Self { mut position, inverse_mass, rest, gaps, softness, solved, is_edge, scratch } = self;
            let chains = Chains {
                count: position.len(),
                position: CellColumn::new(&mut position),
                inverse_mass: &inverse_mass,
                gaps: gaps.as_deref(),
                softness: softness.as_deref(),
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

    /// The compliance of the stick from this place to the next, in parts of that inside the cloth.
    fn compliance_share(line: usize, place: usize) -> f32 {
        1.0 + ((3 * line + place) % 4) as f32
    }

    /// Grids with and without ghosts: patches side by side, and four by four with three to ten lines each.
    #[test]
    #[cfg_attr(miri, ignore = "thousands of solves; `cell_columns` has what Miri looks for")]
    fn each_line_moves_as_it_does_alone() {
        let sticks = |compliance| Solved::Sticks(ElasticStick { rest: 0.1, compliance });
        let cases = [
            (sticks(0.0), false),
            (sticks(0.0), true),
            (sticks(5.0), false),
            (sticks(5.0), true),
            (Solved::Bends(1.0), false),
        ];
        for (columns, rows) in [(9, 12), (17, 30), (32, 31), (24, 40), (40, 20), (64, 70)] {
            let body = crumpled(columns, rows, &[40]);
            let grid = RuledGrid::of(&body.topology).expect("a grid");
            let patches = grid.patches.expect("in patches");
            let (inverse_mass, _) = body.particles.inverse_mass.as_chunks::<LANES>();
            let mut dice = dice(3);
            let mut rest = body.particles.position.cells.clone();
            for cell in &mut rest {
                (0..LANES).for_each(|lane| cell.set(lane, Vec3::new(dice(), dice(), dice()) * 0.01));
            }
            let mut scratch = room_for(80);
            for (lines, (solved, has_gaps)) in
                ALL_LINES.into_iter().flat_map(|lines| cases.map(|case| (lines, case)))
            {
                let is_diagonal = lines.is_diagonal();
                let storage = LineStorage::of(lines, grid);
                let LineStorage::Bundled(bundling) = storage else {
                    assert!(is_diagonal && patches.down > 1, "{lines:?} of {columns} x {rows}");
                    continue;
                };
                if is_diagonal && matches!(solved, Solved::Bends(_)) {
                    continue;
                }
                let has_gaps = has_gaps || is_diagonal;
                let is_gap = |line, place| is_gap(line, place) || !lines.has_stick(grid, [line, place]);
                let (number, count) = lines.size(grid);
                let mut gaps = vec![0; bundling.bundles(number) * count];
                let mut softness = vec![[1.0; LANES]; gaps.len()];
                for (line, place) in (0..number).flat_map(|line| (0..count).map(move |place| (line, place))) {
                    let (bundle, lane) = storage.bundle_of(line);
                    gaps[bundle * count + place] |= u16::from(is_gap(line, place)) << lane;
                    softness[bundle * count + place][lane] = compliance_share(line, place);
                }
                let rest = matches!(solved, Solved::Bends(_)).then_some(&*rest);
                let is_soft = has_gaps && solved == sticks(5.0);
                let torn =
                    TornBundles { gaps: has_gaps.then_some(&*gaps), softness: is_soft.then_some(&*softness) };
                let mut solved_on = |isa| {
                    let mut position = body.particles.position.cells.clone();
                    let projection = StickProjection::Exact;
                    BundleSolve { grid, inverse_mass, rest, torn, lines, bundling, solved, projection, isa }
                        .solve(&mut position, core::slice::from_mut(&mut scratch), &Workers::default());
                    position
                };
                let position = solved_on(Isa::detected());
                for isa in Isa::available() {
                    assert!(solved_on(isa) == position, "{lines:?} of {columns} x {rows} on {}", isa.name());
                }
                for line in 0..number {
                    let slots = (0..count).map(|place| {
                        let [column, row] = lines.column_and_row(grid, [line, place]);
                        patches.slot(column, row)
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
                        softness: is_soft.then(|| {
                            (0..count).map(|place| [compliance_share(line, place); LANES]).collect()
                        }),
                        solved,
                        is_edge: !is_diagonal && is_at_edge(line, number),
                        scratch: &mut scratch,
                    });
                    for (&(cell, lane), alone) in ends.iter().zip(&alone) {
                        assert_eq!(
                            position[cell].get(lane),
                            alone.get(0),
                            "{columns} x {rows}, {lines:?} {line}, {solved:?}, gaps: {has_gaps}"
                        );
                    }
                }
            }
        }
    }
}
