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
use crate::state::membrane::{ElasticStick, Membrane};
use crate::state::settings::{BodySettings, StickProjection, StructuralSolve};
use crate::state::substep::Substep;
use crate::state::topology::{BatchSticks, StickBatch, StickKind, Topology};

/// The lines of a grid in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lines {
    Rows,
    Columns,
    /// From the upper left to the lower right.
    Diagonals,
    /// From the upper right to the lower left.
    Antidiagonals,
}

impl Lines {
    /// The lines that the sticks of `batch` form, if they are to be solved directly: structural sticks of a whole grid that have a
    /// compliance, or lose all of their error at a `stiffness` per iteration and are to be solved so.
    pub fn of(
        batch: &StickBatch,
        stiffness: f32,
        topology: &Topology,
        settings: &BodySettings,
    ) -> Option<Self> {
        let (offset, is_small) = match (&batch.sticks, &topology.membrane) {
            (BatchSticks::Grid { batch, .. }, _) => (batch.offset(), false),
            // Small grids have their sticks in lists.
            (BatchSticks::Listed(_), Some(membrane)) => {
                let ends = topology.stick(batch.first).map(|end| end as usize);
                let [[from, above], [to, below]] =
                    ends.map(|end| [end % membrane.size[0], end / membrane.size[0]]);
                ((to as isize - from as isize, below - above), true)
            }
            _ => return None,
        };
        let lines = match offset {
            (1, 0) => Self::Rows,
            (0, 1) => Self::Columns,
            (1, 1) => Self::Diagonals,
            (-1, 1) => Self::Antidiagonals,
            _ => return None,
        };
        let is_rigid = settings.structural == StructuralSolve::Lines
            && !is_small
            && batch.material.kind == StickKind::Structural
            && stiffness >= 1.0;
        (is_rigid || lines.elastic_sticks(topology).is_some()).then_some(lines)
    }

    /// The sticks of these lines; none if none are to be solved directly.
    pub fn sticks(self, topology: &Topology, stiffness: &[f32], settings: &BodySettings) -> Option<Solved> {
        self.elastic_sticks(topology).or_else(|| {
            let batches = topology.batches.iter().zip(stiffness);
            let mut own = batches
                .filter(|&(batch, &stiffness)| Self::of(batch, stiffness, topology, settings) == Some(self));
            own.find_map(|(batch, _)| match batch.sticks {
                BatchSticks::Grid { rest_length, .. } => {
                    Some(Solved::Sticks(ElasticStick { rest: rest_length, compliance: 0.0 }))
                }
                BatchSticks::Listed(_) | BatchSticks::Loose(_) => None,
            })
        })
    }

    /// The sticks of these lines that have a compliance.
    fn elastic_sticks(self, topology: &Topology) -> Option<Solved> {
        let membrane = topology.membrane.as_ref()?;
        let sticks = match self {
            Self::Rows => membrane.rows,
            Self::Columns => membrane.columns,
            Self::Diagonals | Self::Antidiagonals => membrane.diagonals,
        };
        sticks.map(Solved::Sticks)
    }

    /// The bends of these lines; none if they do not resist.
    pub fn bends(self, topology: &Topology) -> Option<Solved> {
        let [rows, columns] = topology.bends.lines?.compliance;
        let compliance = match self {
            Self::Rows => rows,
            Self::Columns => columns,
            Self::Diagonals | Self::Antidiagonals => None,
        };
        compliance.map(Solved::Bends)
    }

    /// The number of lines, and of places in a line.
    fn size(self, RuledGrid { columns, rows, .. }: RuledGrid) -> (usize, usize) {
        match self {
            Self::Rows => (rows, columns),
            Self::Columns => (columns, rows),
            Self::Diagonals | Self::Antidiagonals => (columns, rows + 2 * (rows - 1).div_ceil(columns)),
        }
    }

    fn storage(self, grid: RuledGrid) -> LineStorage {
        match (self, grid.patches) {
            (Self::Diagonals | Self::Antidiagonals, _) => LineStorage::Gathered,
            _ if self.size(grid).0 < LEAST_BUNDLED_LINES => LineStorage::Lone,
            (Self::Rows, Some(patches)) if patches.down == 1 => LineStorage::Transposed,
            (Self::Columns, Some(patches)) if patches.down == 1 => LineStorage::InPlace,
            _ => LineStorage::Gathered,
        }
    }

    /// The places of line `line`.
    ///
    /// Diagonals go on at the other side of the grid, so that all have a particle in each row. Two ghosts cut the line there, at the
    /// places of the particles on both sides: sticks without length do not pull.
    fn places(self, grid: RuledGrid, line: usize) -> Vec<LinePlace> {
        let RuledGrid { columns, rows, .. } = grid;
        let particle =
            |column: usize, row: usize| LinePlace { index: row * columns + column, is_ghost: false };
        let column_of = |row: usize| match self {
            Self::Diagonals => (line + row) % columns,
            _ => columns - 1 - (line + row) % columns,
        };
        let mut places = Vec::with_capacity(self.size(grid).1);
        match self {
            Self::Rows => places.extend((0..columns).map(|column| particle(column, line))),
            Self::Columns => places.extend((0..rows).map(|row| particle(line, row))),
            Self::Diagonals | Self::Antidiagonals => {
                for row in 0..rows {
                    let place = particle(column_of(row), row);
                    if let Some(&before) = places.last()
                        && (line + row) % columns == 0
                    {
                        places.extend([before, place].map(LinePlace::ghost));
                    }
                    places.push(place);
                }
                let last = particle(column_of(rows - 1), rows - 1).ghost();
                places.resize(self.size(grid).1, last);
            }
        }
        places
    }
}

/// A particle of a line, or a ghost of it, which is pinned there and stays behind.
#[derive(Clone, Copy, Debug)]
struct LinePlace {
    index: usize,
    is_ghost: bool,
}

impl LinePlace {
    fn ghost(self) -> Self {
        Self { is_ghost: true, ..self }
    }
}

/// Marks the slot of a ghost.
const GHOST: u32 = 1 << 31;

/// The resistance of lines that are solved directly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solved {
    /// Sticks, with their compliance in m/N.
    Sticks(ElasticStick),
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
        let small = || {
            let bent = topology.bends.lines.map(|BentGrid { columns, rows, .. }| [columns, rows]);
            bent.or_else(|| topology.membrane.map(|Membrane { size, .. }| size))
        };
        match &topology.layout {
            &Layout::Grid(grid) => Some(Self { columns: grid.columns, rows: grid.rows, patches: Some(grid) }),
            Layout::Linear { .. } | Layout::Renumbered(_) => {
                small().map(|[columns, rows]| Self { columns, rows, patches: None })
            }
            Layout::Torn(_) => None,
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
    /// sixteen lines at a time. Ghosts are [marked](GHOST).
    slots: [Vec<u32>; 4],
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
        let diagonals = topology.membrane.is_some_and(|membrane| membrane.diagonals.is_some());
        let all = [Lines::Rows, Lines::Columns, Lines::Diagonals, Lines::Antidiagonals];
        for lines in all.into_iter().take(if diagonals { 4 } else { 2 }) {
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
    let edges = (0..LANES).fold(0, |bits, lane| bits | (u16::from(is_edge(lane)) << lane));
    match solved {
        Solved::Sticks(stick) => chains.solve(simd, chain, stick, edges, projection),
        Solved::Bends(compliance) => chains.bend(simd, bends, compliance, edges),
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
    let slot = |place: LinePlace| layout.slot(place.index) as u32 | if place.is_ghost { GHOST } else { 0 };
    let mut slots = Vec::with_capacity(number * count);
    for bundle in bundles {
        let all: Vec<_> = bundle.map(|line| lines.places(grid, line)).collect();
        slots.extend((0..count).flat_map(|i| all.iter().map(move |places| slot(places[i]))));
    }
    slots
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
    let compliance_scale = context.compliance_scale;
    let solve =
        LineSolve { grid, position, inverse_mass, lone_steps, compliance_scale, length_ratio, scratch };
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
    /// Line solves in a substep over its square, in 1/s^2.
    compliance_scale: f32,
    /// Factor on rest lengths.
    length_ratio: f32,
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
        let Self { grid, position, inverse_mass, lone_steps, scratch, .. } = self;
        let LineScratch { lone, slots, .. } = &mut **scratch;
        let (number, count) = lines.size(*grid);
        // A second step would pull once more at a spring.
        let steps = if stick.compliance > 0.0 { 1 } else { *lone_steps };
        for (line, slots) in slots[lines as usize].chunks_exact(count).enumerate() {
            let width = if is_at_edge(line, number) { 0.5 } else { 1.0 };
            let stick = ElasticStick { compliance: stick.compliance / width, ..stick };
            for _ in 0..steps {
                LoneChain { position, inverse_mass, slots }.solve(lone, stick, projection);
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
                    let place = (slot & !GHOST) as usize;
                    let (from, in_lane) = (place / LANES, place % LANES);
                    gathered[i].set(lane, position[from].get(in_lane));
                    gathered_mass[i][lane] =
                        if slot & GHOST == 0 { inverse_mass[from][in_lane] } else { 0.0 };
                }
            }
            let chains =
                Chains { position: gathered, inverse_mass: gathered_mass, first: 0, stride: 1, count };
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
