//! Line solves: the rows and the columns of a grid, each solved as one [chain](crate::constraint::direct::chain).
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
use crate::constraint::direct::lone_chain::{LoneChain, LoneStick};
use crate::constraint::projection::{Exact, Projection, SquareRootFree};
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::simd::lanes::load;
use crate::simd::transpose::transpose;
use crate::state::bends::{BentGrid, is_at_edge};
use crate::state::body::Body;
use crate::state::layout::{Grid, Layout};
use crate::state::settings::{BodySettings, StickProjection, StructuralSolve};
use crate::state::substep::Substep;
use crate::state::topology::{BatchSticks, StickBatch, StickKind, Topology};

/// The rows or the columns of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lines {
    Rows,
    Columns,
}

impl Lines {
    /// The lines that the sticks of `batch` form, if they are to be solved directly: structural sticks of a grid that
    /// lose all of their error at a `stiffness` per iteration.
    pub fn of(batch: &StickBatch, stiffness: f32, settings: &BodySettings) -> Option<Self> {
        if settings.structural == StructuralSolve::Sweeps
            || batch.material.kind != StickKind::Structural
            || stiffness < 1.0
        {
            return None;
        }
        let BatchSticks::Grid { batch, .. } = &batch.sticks else {
            return None;
        };
        match batch.offset() {
            (1, 0) => Some(Self::Rows),
            (0, 1) => Some(Self::Columns),
            _ => None,
        }
    }

    /// Rest length in metres of the sticks of these lines; none if none are to be solved directly.
    pub fn rest_length(self, topology: &Topology, stiffness: &[f32], settings: &BodySettings) -> Option<f32> {
        let batches = topology.batches.iter().zip(stiffness);
        let mut own =
            batches.filter(|&(batch, &stiffness)| Self::of(batch, stiffness, settings) == Some(self));
        own.find_map(|(batch, _)| match batch.sticks {
            BatchSticks::Grid { rest_length, .. } => Some(rest_length),
            BatchSticks::Listed(_) | BatchSticks::Loose(_) => None,
        })
    }

    /// Compliance in m/N of the bends along these lines; none if they do not resist.
    pub fn compliance(self, topology: &Topology) -> Option<f32> {
        let [rows, columns] = topology.bends.lines?.compliance;
        match self {
            Self::Rows => rows,
            Self::Columns => columns,
        }
    }

    /// The number of lines, and of particles in a line.
    fn size(self, RuledGrid { columns, rows, .. }: RuledGrid) -> (usize, usize) {
        match self {
            Self::Rows => (rows, columns),
            Self::Columns => (columns, rows),
        }
    }

    fn storage(self, grid: RuledGrid) -> LineStorage {
        match (self, grid.patches) {
            _ if self.size(grid).0 < LEAST_BUNDLED_LINES => LineStorage::Lone,
            (Self::Rows, Some(patches)) if patches.down == 1 => LineStorage::Transposed,
            (Self::Columns, Some(patches)) if patches.down == 1 => LineStorage::InPlace,
            _ => LineStorage::Gathered,
        }
    }

    /// The index of particle `i` of line `line`.
    fn index(self, grid: RuledGrid, line: usize, i: usize) -> usize {
        match self {
            Self::Rows => line * grid.columns + i,
            Self::Columns => i * grid.columns + line,
        }
    }
}

/// The resistance of lines that are solved directly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solved {
    /// Sticks of this length at rest, in metres.
    Sticks(f32),
    /// Bends of this compliance inside the cloth, in m/N.
    Bends(f32),
}

/// A grid of particles, by rows and columns: in patches, or in order if it is too small for that.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RuledGrid {
    columns: usize,
    rows: usize,
    patches: Option<Grid>,
}

impl RuledGrid {
    /// The whole grid of a topology.
    fn of(topology: &Topology) -> Option<Self> {
        match (&topology.layout, topology.bends.lines) {
            (&Layout::Grid(grid), _) => {
                Some(Self { columns: grid.columns, rows: grid.rows, patches: Some(grid) })
            }
            (Layout::Linear { .. } | Layout::Renumbered(_), Some(BentGrid { columns, rows, .. })) => {
                Some(Self { columns, rows, patches: None })
            }
            _ => None,
        }
    }
}

/// The way that lines come into the lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineStorage {
    /// Columns: each is in a lane already.
    InPlace,
    /// Rows: they run through all lanes.
    Transposed,
    /// Lines that run through some of the lanes.
    Gathered,
    /// Solved one by one, because there are too few of them.
    Lone,
}

/// Least number of lines that are solved side by side.
const LEAST_BUNDLED_LINES: usize = 4;

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
    /// sixteen lines at a time.
    slots: [Vec<u32>; 2],
    grid: Option<RuledGrid>,
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
        if self.grid == Some(grid) {
            return;
        }
        for lines in [Lines::Rows, Lines::Columns] {
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
        self.grid = Some(grid);
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
    match solved {
        Solved::Sticks(rest) => chains.solve(simd, chain, rest, projection),
        Solved::Bends(compliance) => {
            let edges = (0..LANES).fold(0, |bits, lane| bits | (u16::from(is_edge(lane)) << lane));
            chains.bend(simd, bends, compliance, edges);
        }
    }
}

/// The slots of the particles of all lines that must be gathered.
fn slots(layout: &Layout, grid: RuledGrid, lines: Lines) -> Vec<u32> {
    let lanes = match lines.storage(grid) {
        LineStorage::Gathered => LANES,
        LineStorage::Lone => 1,
        LineStorage::InPlace | LineStorage::Transposed => return Vec::new(),
    };
    let (number, count) = lines.size(grid);
    let bundles = (0..number).step_by(lanes).map(move |first| first..number.min(first + lanes));
    let places = bundles.flat_map(|bundle| (0..count).map(move |i| (bundle.clone(), i)));
    let slot = |line: usize, i: usize| layout.slot(lines.index(grid, line, i)) as u32;
    places.flat_map(|(bundle, i)| bundle.map(move |line| slot(line, i))).collect()
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
    let lone_steps = if settings.iterations == 1 { 2 } else { 1 };
    let bend_scale = context.bend_scale;
    let solve = LineSolve { grid, position, inverse_mass, lone_steps, bend_scale, length_ratio, scratch };
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
    /// The number of Newton steps on each lone line. A rope that is taut between two pins has hardly a curve to pull
    /// straight, so its pull is far too strong for the smallest waves on it: one step in a substep leaves them
    /// oscillating, a second removes them.
    lone_steps: u32,
    /// Iterations over the square of a substep, in 1/s^2.
    bend_scale: f32,
    /// Factor on rest lengths.
    length_ratio: f32,
    scratch: &'a mut LineScratch,
}

impl LineSolve<'_> {
    /// Solves all `lines`.
    #[inline(always)]
    fn solve<S: Simd>(&mut self, simd: S, lines: Lines, mut solved: Solved, projection: impl Projection) {
        match &mut solved {
            Solved::Sticks(rest_length) => *rest_length *= self.length_ratio,
            Solved::Bends(compliance) => *compliance *= self.bend_scale,
        }
        match (lines.storage(self.grid), solved, self.grid.patches) {
            (LineStorage::InPlace, _, Some(patches)) => {
                self.columns_in_place(simd, patches, solved, projection);
            }
            (LineStorage::Transposed, _, Some(patches)) => {
                self.transposed_rows(simd, patches, solved, projection);
            }
            (LineStorage::Lone, Solved::Sticks(rest), _) => self.lone(lines, rest, projection),
            // Lone lines that bend are gathered one by one.
            (LineStorage::Lone, ..) => self.gathered(simd, lines, 1, solved, projection),
            _ => self.gathered(simd, lines, LANES, solved, projection),
        }
    }

    #[inline(always)]
    fn lone(&mut self, lines: Lines, rest: f32, projection: impl Projection) {
        let Self { grid, position, inverse_mass, lone_steps, scratch, .. } = self;
        let LineScratch { lone, slots, .. } = &mut **scratch;
        for slots in slots[lines as usize].chunks_exact(lines.size(*grid).1) {
            for _ in 0..*lone_steps {
                LoneChain { position, inverse_mass, slots }.solve(lone, rest, projection);
            }
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
        let Self { grid, position, inverse_mass, scratch, .. } = self;
        let LineScratch { chain, bends, .. } = &mut **scratch;
        for first in 0..patches.width {
            let chains = Chains { position, inverse_mass, first, stride: patches.width, count: grid.rows };
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
            let chains = Chains { position, inverse_mass, first: 0, stride: 1, count: self.grid.columns };
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
        let Self { grid, position, inverse_mass, scratch, .. } = self;
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
                    let (from, in_lane) = (slot as usize / LANES, slot as usize % LANES);
                    gathered[i].set(lane, position[from].get(in_lane));
                    gathered_mass[i][lane] = inverse_mass[from][in_lane];
                }
            }
            let chains =
                Chains { position: gathered, inverse_mass: gathered_mass, first: 0, stride: 1, count };
            let is_edge = |lane| is_at_edge(first + lane, number);
            solve_chains(simd, chains, (chain, bends), solved, is_edge, projection);
            for (i, slots) in bundle.chunks_exact(lanes).enumerate() {
                for (lane, &slot) in slots.iter().enumerate() {
                    position[slot as usize / LANES].set(slot as usize % LANES, gathered[i].get(lane));
                }
            }
        }
    }
}
