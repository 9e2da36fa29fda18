//! Line solves: the [lines of a grid](crate::constraint::direct::grid_lines), each solved as one
//! [chain](crate::constraint::direct::chain).
//!
//! ```text
//!   columns, patches side by side         rows, the same                         patches in a square
//!   lane = column: solved in place        sixteen rows at a time are transposed:     sixteen lines at a time are
//!                                         lane = row; solved; transposed back        gathered, solved, scattered
//! ```
//!
//! Ropes, and other grids of very few lines, are solved one [line](crate::constraint::direct::lone_chain) at a time.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, prelude::*};

use crate::constraint::direct::bent_chain::ChainBend;
use crate::constraint::direct::chain::{ChainScratch, Chains};
use crate::constraint::direct::grid_lines::{GHOST, LineStorage, Lines, RuledGrid, Solved, slots};
use crate::constraint::direct::lone_chain::{LoneChain, LoneStick};
use crate::constraint::projection::{Exact, Projection, SquareRootFree};
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::simd::lanes::load;
use crate::simd::transpose::transpose;
use crate::state::bends::is_at_edge;
use crate::state::body::Body;
use crate::state::layout::Grid;
use crate::state::membrane::ElasticStick;
use crate::state::settings::StickProjection;
use crate::state::substep::Substep;
use crate::state::topology::Topology;

/// Scratch of line solves. Only its memory outlives a solve, and only the list of slots the step.
#[derive(Clone, Debug, Default)]
pub(crate) struct LineScratch {
    chain: ChainScratch,
    bends: Vec<ChainBend>,
    /// The particles of sixteen lines, lane by lane.
    position: Vec<Cell>,
    inverse_mass: Vec<[f32; LANES]>,
    lone: Vec<LoneStick>,
    /// Slots of gathered and lone lines: those of their first particles, then of their second, and so on, for up to
    /// sixteen lines at a time. Ghosts are [marked](GHOST).
    slots: [Vec<u32>; 4],
    /// The grid for which it has room, and true if that has diagonals.
    made_for: Option<(RuledGrid, bool)>,
}

impl LineScratch {
    /// Makes room for the lines of a body.
    pub fn reserve(&mut self, topology: &Topology) {
        let Some(grid) = RuledGrid::of(topology) else {
            return;
        };
        if topology.bends.lines.is_some() {
            let count = grid.columns.max(grid.rows);
            grow(&mut self.bends, count);
            grow(&mut self.position, count);
            grow(&mut self.inverse_mass, count);
        }
        let has_diagonals = topology.membrane.is_some_and(|membrane| membrane.diagonals.is_some());
        if self.made_for == Some((grid, has_diagonals)) {
            return;
        }
        let all = [Lines::Rows, Lines::Columns, Lines::Diagonals, Lines::Antidiagonals];
        for lines in all.into_iter().take(if has_diagonals { 4 } else { 2 }) {
            let (_, count) = lines.size(grid);
            let storage = lines.storage(grid);
            // Transposed rows include the ghosts at their end.
            let transposed = grid.patches.map_or(count, |patches| count.max(patches.across * patches.width));
            match storage {
                LineStorage::Lone => grow(&mut self.lone, count),
                LineStorage::InPlace => self.chain.reserve(count),
                LineStorage::Transposed | LineStorage::Gathered => {
                    self.chain.reserve(count);
                    grow(&mut self.position, transposed);
                    grow(&mut self.inverse_mass, transposed);
                }
            }
            self.slots[lines as usize] = slots(&topology.layout, grid, lines);
        }
        self.made_for = Some((grid, has_diagonals));
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let slots = self.slots.iter().map(|slots| size_of_val(&**slots)).sum::<usize>();
        let lanes =
            size_of_val(&*self.position) + size_of_val(&*self.inverse_mass) + size_of_val(&*self.bends);
        self.chain.bytes() + lanes + size_of_val(&*self.lone) + slots
    }
}

/// Makes room for `count` values.
fn grow<T: Clone + Default>(values: &mut Vec<T>, count: usize) {
    values.resize(count.max(values.len()), T::default());
}

/// Solves chains whose sticks or bends resist alike, but for those of lanes at an edge of the cloth.
#[inline(always)]
fn solve_chains<S: Simd>(
    simd: S,
    mut chains: Chains,
    (chain, bends): (&mut ChainScratch, &mut [ChainBend]),
    solved: Solved,
    is_edge: impl Fn(usize) -> bool,
    projection: impl Projection,
) {
    let edges = (0..LANES).fold(0, |bits, lane| bits | (u16::from(is_edge(lane)) << lane));
    match solved {
        Solved::Sticks(stick) => chains.solve(simd, chain, stick, edges, projection),
        Solved::Bends(compliance) => chains.bend(simd, bends, compliance, edges),
    }
}

/// Solves the lines of a body, as its plan lists them.
pub(crate) fn solve(body: &mut Body, lines: &[(Lines, Solved)], scratch: &mut LineScratch, substep: Substep) {
    let Body { particles, topology, settings, context, .. } = body;
    let Some(grid) = RuledGrid::of(topology) else {
        return;
    };
    let length_ratio = particles.length_ratio(substep);
    let (inverse_mass, _) = particles.inverse_mass.as_chunks::<LANES>();
    let position = &mut particles.position.cells;
    let compliance_scale = context.compliance_scale;
    let turns_when_taut = topology.line_solves(settings.iterations) == 1;
    let solve =
        LineSolve { grid, position, inverse_mass, compliance_scale, length_ratio, turns_when_taut, scratch };
    match settings.projection {
        StickProjection::Exact => substep.isa.run(SolveAll { solve, lines, projection: Exact }),
        StickProjection::SquareRootFree => {
            substep.isa.run(SolveAll { solve, lines, projection: SquareRootFree });
        }
    }
}

struct SolveAll<'a, P> {
    solve: LineSolve<'a>,
    lines: &'a [(Lines, Solved)],
    projection: P,
}

impl<P: Projection> Kernel for SolveAll<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        for &(lines, solved) in self.lines {
            self.solve.solve(simd, lines, solved, self.projection);
        }
    }
}

/// The particles whose lines are to be solved.
struct LineSolve<'a> {
    grid: RuledGrid,
    position: &'a mut [Cell],
    inverse_mass: &'a [[f32; LANES]],
    /// The number of line solves in a substep over the square of its duration, in 1/s^2.
    compliance_scale: f32,
    /// Factor on rest lengths.
    length_ratio: f32,
    /// True if taut lines turn implicitly: where they are solved once in a substep. A second solve calms them as well, and small sheets
    /// would gain energy by both.
    turns_when_taut: bool,
    scratch: &'a mut LineScratch,
}

impl LineSolve<'_> {
    /// Solves all `lines`.
    #[inline(always)]
    fn solve<S: Simd>(&mut self, simd: S, lines: Lines, mut solved: Solved, projection: impl Projection) {
        match &mut solved {
            Solved::Sticks(stick) => {
                stick.rest *= self.length_ratio;
                stick.compliance *= self.compliance_scale;
            }
            Solved::Bends(compliance) => *compliance *= self.compliance_scale,
        }
        match (lines.storage(self.grid), solved, self.grid.patches) {
            (LineStorage::InPlace, _, Some(patches)) => {
                self.columns_in_place(simd, patches, solved, projection);
            }
            (LineStorage::Transposed, _, Some(patches)) => {
                self.transposed_rows(simd, patches, solved, projection);
            }
            (LineStorage::Lone, Solved::Sticks(stick), _) => self.lone(lines, stick, projection),
            // Lone lines that bend are gathered one by one.
            (LineStorage::Lone, ..) => self.gathered(simd, lines, 1, solved, projection),
            _ => self.gathered(simd, lines, LANES, solved, projection),
        }
    }

    #[inline(always)]
    fn lone(&mut self, lines: Lines, stick: ElasticStick, projection: impl Projection) {
        let Self { grid, position, inverse_mass, turns_when_taut, scratch, .. } = self;
        let LineScratch { lone, slots, .. } = &mut **scratch;
        let (number, count) = lines.size(*grid);
        for (line, slots) in slots[lines as usize].chunks_exact(count).enumerate() {
            let width = if is_at_edge(line, number) { 0.5 } else { 1.0 };
            let stick = ElasticStick { compliance: stick.compliance / width, ..stick };
            LoneChain { position, inverse_mass, slots, turns_when_taut: *turns_when_taut }
                .solve(lone, stick, projection);
        }
    }

    #[inline(always)]
    fn columns_in_place<S: Simd>(
        &mut self,
        simd: S,
        patches: Grid,
        solved: Solved,
        projection: impl Projection,
    ) {
        let Self { grid, position, inverse_mass, turns_when_taut, scratch, .. } = self;
        let LineScratch { chain, bends, .. } = &mut **scratch;
        for first in 0..patches.width {
            let chains = Chains {
                position,
                inverse_mass,
                first,
                stride: patches.width,
                count: grid.rows,
                turns_when_taut: *turns_when_taut,
            };
            let is_edge = |lane| is_at_edge(lane * patches.width + first, grid.columns);
            solve_chains(simd, chains, (chain, bends), solved, is_edge, projection);
        }
    }

    #[inline(always)]
    fn transposed_rows<S: Simd>(
        &mut self,
        simd: S,
        patches: Grid,
        solved: Solved,
        projection: impl Projection,
    ) {
        for first in (0..self.grid.rows).step_by(LANES) {
            self.transpose_rows(simd, patches, first);
            let LineScratch { chain, bends, position, inverse_mass, .. } = &mut *self.scratch;
            let chains = Chains {
                position,
                inverse_mass,
                first: 0,
                stride: 1,
                count: self.grid.columns,
                turns_when_taut: self.turns_when_taut,
            };
            let is_edge = |lane| is_at_edge(first + lane, self.grid.rows);
            solve_chains(simd, chains, (chain, bends), solved, is_edge, projection);
            self.transpose_back(simd, patches, first);
        }
    }

    /// Transposes sixteen rows from row `first` on into chains side by side. Spare lanes repeat the last row.
    ///
    /// Each place in a patch is a cell of every row; after the transposition, each patch is a cell of the chains.
    fn transpose_rows<S: Simd>(&mut self, simd: S, patches: Grid, first: usize) {
        let Self { grid, position, inverse_mass, scratch, .. } = self;
        let LineScratch { position: transposed, inverse_mass: transposed_mass, .. } = &mut **scratch;
        let (width, last) = (patches.width, grid.rows - 1);
        simd.vectorize(
            #[inline(always)]
            || {
                for column in 0..width {
                    let cell = |row: usize| (first + row).min(last) * width + column;
                    for axis in 0..3 {
                        transpose(
                            #[inline(always)]
                            |row| load(simd, position[cell(row)].axes()[axis]),
                            #[inline(always)]
                            |patch, of_rows| {
                                *transposed[patch * width + column].axes_mut()[axis] = of_rows.to_array();
                            },
                        );
                    }
                    transpose(
                        #[inline(always)]
                        |row| load(simd, &inverse_mass[cell(row)]),
                        #[inline(always)]
                        |patch, of_rows| transposed_mass[patch * width + column] = of_rows.to_array(),
                    );
                }
            },
        );
    }

    /// The inverse of [`transpose_rows`](Self::transpose_rows).
    fn transpose_back<S: Simd>(&mut self, simd: S, patches: Grid, first: usize) {
        let Self { grid, position, scratch, .. } = self;
        let transposed = &scratch.position;
        let (width, rows) = (patches.width, grid.rows);
        simd.vectorize(
            #[inline(always)]
            || {
                for column in 0..width {
                    for axis in 0..3 {
                        transpose(
                            #[inline(always)]
                            |patch| load(simd, transposed[patch * width + column].axes()[axis]),
                            #[inline(always)]
                            |row, of_patches| {
                                if first + row < rows {
                                    let cell = (first + row) * width + column;
                                    *position[cell].axes_mut()[axis] = of_patches.to_array();
                                }
                            },
                        );
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn gathered<S: Simd>(
        &mut self,
        simd: S,
        lines: Lines,
        side_by_side: usize,
        solved: Solved,
        projection: impl Projection,
    ) {
        let Self { grid, position, inverse_mass, turns_when_taut, scratch, .. } = self;
        let (number, count) = lines.size(*grid);
        let LineScratch { chain, bends, position: gathered, inverse_mass: gathered_mass, slots, .. } =
            &mut **scratch;
        let mut slots = slots[lines as usize].as_slice();
        for first in (0..number).step_by(side_by_side) {
            let lanes = side_by_side.min(number - first);
            let bundle;
            (bundle, slots) = slots.split_at(lanes * count);
            // Spare lanes keep their old values, which nothing reads.
            for (i, slots) in bundle.chunks_exact(lanes).enumerate() {
                for (lane, &slot) in slots.iter().enumerate() {
                    let place = (slot & !GHOST) as usize;
                    let (from, in_lane) = (place / LANES, place % LANES);
                    gathered[i].set(lane, position[from].get(in_lane));
                    gathered_mass[i][lane] =
                        if slot & GHOST == 0 { inverse_mass[from][in_lane] } else { 0.0 };
                }
            }
            let chains = Chains {
                position: gathered,
                inverse_mass: gathered_mass,
                first: 0,
                stride: 1,
                count,
                turns_when_taut: *turns_when_taut,
            };
            // A diagonal belongs to one square alone.
            let is_side = matches!(lines, Lines::Rows | Lines::Columns);
            let is_edge = |lane| is_side && is_at_edge(first + lane, number);
            solve_chains(simd, chains, (chain, bends), solved, is_edge, projection);
            for (i, slots) in bundle.chunks_exact(lanes).enumerate() {
                for (lane, &slot) in slots.iter().enumerate().filter(|(_, slot)| **slot & GHOST == 0) {
                    position[slot as usize / LANES].set(slot as usize % LANES, gathered[i].get(lane));
                }
            }
        }
    }
}
