//! Line solves: the [lines of a grid](crate::constraint::direct::grid_lines), each solved as one
//! [chain](crate::constraint::direct::chain).
//!
//! ```text
//!   columns, patches side by side         rows, the same                             patches four by four
//!   lane = column: solved in place        sixteen rows at a time are transposed:     four lines of each patch are
//!                                         lane = row; solved; transposed back        shuffled, solved, shuffled back
//! ```
//!
//! Diagonals of patches side by side change their lanes. All other lines, as diagonals of patches four by four and lines of grids without
//! patches, are gathered sixteen at a time, solved and scattered.
//! Ropes, other grids of very few lines, and loose lines of torn grids are solved one [line](crate::constraint::direct::lone_chain) at a time.
//!
//! Design: `docs/design/line_solves.md`.

use std::sync::Arc;

use fearless_simd::Simd;

use crate::constraint::direct::bundle::{BundleScratch, BundleSolve, grow, solve_chains};
use crate::constraint::direct::chain::Chains;
use crate::constraint::direct::grid_lines::{ALL_LINES, Lines, RuledGrid, Solved};
use crate::constraint::direct::line_storage::{Bundling, LineStorage, slots};
use crate::constraint::direct::lone_chain::{LoneChain, LoneStick};
use crate::constraint::direct::torn_lines::{LoneLine, TornLines};
use crate::constraint::direct::{shared_bundles, thread_friction};
use crate::constraint::projection::{Exact, Projection, SquareRootFree};
use crate::parallel::workers::Workers;
use crate::simd::cell_columns::CellColumn;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::state::bends::is_at_edge;
use crate::state::body::Body;
use crate::state::membrane::ElasticStick;
use crate::state::settings::StickProjection;
use crate::state::substep::Substep;
use crate::state::topology::Topology;

/// Scratch of line solves. Only its memory outlives a solve, and only lists of slots and gaps the step.
#[derive(Clone, Debug, Default)]
pub(crate) struct LineScratch {
    /// One for each thread that may be called.
    bundles: Vec<BundleScratch>,
    lone: Vec<LoneStick>,
    /// Slots of gathered and lone lines: those of their first particles, then of their second, and so on, for up to
    /// sixteen lines at a time.
    slots: [Vec<u32>; 4],
    /// The grid for which it has room, and true if that has diagonals.
    made_for: Option<(RuledGrid, bool)>,
    /// Gaps in lines, and loose lines of a torn grid.
    torn: TornLines,
}

impl LineScratch {
    /// Makes room for the lines of a body.
    pub fn reserve(&mut self, topology: &Arc<Topology>) {
        let grid = RuledGrid::of(topology);
        if self.torn.note(topology, grid) {
            grow(&mut self.lone, self.torn.longest());
        }
        let Some(grid) = grid else {
            return;
        };
        if self.bundles.is_empty() {
            self.bundles.push(BundleScratch::default());
        }
        for bundle in &mut self.bundles {
            if topology.bends.lines.is_some() {
                let count = grid.columns.max(grid.rows);
                grow(&mut bundle.bends, count);
                bundle.reserve_particles(count);
                if topology.bends.has_friction() {
                    let places = [Lines::Rows, Lines::Columns].map(|lines| {
                        let (_, count) = lines.size(grid);
                        LineStorage::of(lines, grid).places(count)
                    });
                    grow(&mut bundle.rest, places[0].max(places[1]));
                }
            }
        }
        let has_diagonals = Lines::Diagonals.can_be_solved(topology);
        if self.made_for == Some((grid, has_diagonals)) {
            return;
        }
        for lines in ALL_LINES.into_iter().filter(|lines| lines.can_be_solved(topology)) {
            let (_, count) = lines.size(grid);
            let storage = LineStorage::of(lines, grid);
            for bundle in &mut self.bundles {
                match storage {
                    LineStorage::Lone => {}
                    LineStorage::Bundled(Bundling::InPlace { .. }) => bundle.chain.reserve(count),
                    LineStorage::Bundled(_) | LineStorage::Gathered => {
                        bundle.chain.reserve(count);
                        bundle.reserve_particles(storage.places(count));
                    }
                }
            }
            if storage == LineStorage::Lone {
                grow(&mut self.lone, count);
            }
            self.slots[lines as usize] = slots(&topology.layout, grid, lines);
        }
        self.made_for = Some((grid, has_diagonals));
    }

    /// Makes room for `threads` threads.
    fn share(&mut self, threads: usize) {
        if threads > self.bundles.len()
            && let Some(first) = self.bundles.first().cloned()
        {
            self.bundles.resize(threads, first);
        }
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let slots = self.slots.iter().map(|slots| size_of_val(&**slots)).sum::<usize>();
        let bundles = self.bundles.iter().map(BundleScratch::bytes).sum::<usize>();
        bundles + size_of_val(&*self.lone) + slots + self.torn.bytes()
    }
}

/// Solves the lines of a body, as its plan lists them.
pub(crate) fn solve(
    body: &mut Body,
    lines: &[(Lines, Solved)],
    scratch: &mut LineScratch,
    substep: Substep,
    workers: &Workers,
) {
    let Body { particles, topology, settings, context, .. } = body;
    let grid = RuledGrid::of(topology);
    let length_ratio = particles.length_ratio(substep);
    let (inverse_mass, _) = particles.inverse_mass.as_chunks::<LANES>();
    // Particles without a place in a torn grid follow behind it.
    let patches = grid.and_then(|grid| grid.patches);
    let cells = patches.map_or(particles.position.cells.len(), |patches| patches.width * patches.height);
    scratch.share(shared_bundles::threads(workers.most(), cells));
    for &(lines, mut solved) in lines {
        match &mut solved {
            Solved::Sticks(stick) => {
                stick.rest *= length_ratio;
                stick.compliance *= context.compliance_scale;
            }
            Solved::Bends(compliance) => *compliance *= context.compliance_scale,
        }
        let rest = match solved {
            Solved::Bends(_) => lines.rest(topology, &context.bends),
            Solved::Sticks(_) => None,
        };
        let (projection, isa) = (settings.projection, substep.isa);
        let all = &mut *particles.position.cells;
        if let Solved::Sticks(stick) = solved
            && scratch.torn.lone(lines).next().is_some()
        {
            isa.run(LoneLines { lines, stick, projection, position: all, inverse_mass, scratch });
        }
        let Some(grid) = grid else { continue };
        let bundling = match LineStorage::of(lines, grid) {
            LineStorage::Bundled(bundling) => Some(bundling),
            // Solved one by one above.
            LineStorage::Lone if topology.is_torn_grid() => continue,
            LineStorage::Gathered | LineStorage::Lone => None,
        };
        let position = &mut all[..cells];
        if let Some(bundling) = bundling {
            let torn = scratch.torn.bundles(lines);
            BundleSolve { grid, lines, bundling, inverse_mass, rest, torn, solved, projection, isa }.solve(
                position,
                &mut scratch.bundles,
                workers,
            );
        } else {
            isa.run(ScatteredLines {
                lines,
                solved,
                projection,
                grid,
                position,
                inverse_mass,
                rest,
                scratch,
            });
        }
    }
    thread_friction::follow(body, substep.isa);
}

/// Lines of a torn grid that no bundle takes.
struct LoneLines<'a> {
    lines: Lines,
    stick: ElasticStick,
    projection: StickProjection,
    position: &'a mut [Cell],
    inverse_mass: &'a [[f32; LANES]],
    scratch: &'a mut LineScratch,
}

impl Kernel for LoneLines<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { lines, stick, projection, position, inverse_mass, scratch } = self;
        let LineScratch { lone, torn, .. } = scratch;
        for LoneLine { slots, softness } in torn.lone(lines) {
            let mut chain = LoneChain { position, inverse_mass, slots, softness };
            match projection {
                StickProjection::Exact => chain.solve(lone, stick, Exact),
                StickProjection::SquareRootFree => chain.solve(lone, stick, SquareRootFree),
            }
        }
    }
}

/// Lines that run through some of the lanes, and their particles.
struct ScatteredLines<'a> {
    lines: Lines,
    solved: Solved,
    projection: StickProjection,
    grid: RuledGrid,
    position: &'a mut [Cell],
    inverse_mass: &'a [[f32; LANES]],
    rest: Option<&'a [Cell]>,
    scratch: &'a mut LineScratch,
}

impl Kernel for ScatteredLines<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        match self.projection {
            StickProjection::Exact => self.solve(simd, Exact),
            StickProjection::SquareRootFree => self.solve(simd, SquareRootFree),
        }
    }
}

impl ScatteredLines<'_> {
    #[inline(always)]
    fn solve<S: Simd>(&mut self, simd: S, projection: impl Projection) {
        match (LineStorage::of(self.lines, self.grid), self.solved) {
            (LineStorage::Lone, Solved::Sticks(stick)) => self.lone(stick, projection),
            // Lone lines that bend are gathered one by one.
            (LineStorage::Lone, _) => self.gathered(simd, 1, projection),
            _ => self.gathered(simd, LANES, projection),
        }
    }

    #[inline(always)]
    fn lone(&mut self, stick: ElasticStick, projection: impl Projection) {
        let &mut Self { lines, grid, ref mut position, inverse_mass, ref mut scratch, .. } = self;
        let LineScratch { lone, slots, .. } = &mut **scratch;
        let (number, count) = lines.size(grid);
        for (line, slots) in slots[lines as usize].chunks_exact(count).enumerate() {
            let width = if is_at_edge(line, number) { 0.5 } else { 1.0 };
            let stick = ElasticStick { compliance: stick.compliance / width, ..stick };
            LoneChain { position, inverse_mass, slots, softness: None }.solve(lone, stick, projection);
        }
    }

    #[inline(always)]
    fn gathered<S: Simd>(&mut self, simd: S, side_by_side: usize, projection: impl Projection) {
        let &mut Self { lines, solved, grid, ref mut position, inverse_mass, rest, ref mut scratch, .. } =
            self;
        let (number, count) = lines.size(grid);
        let LineScratch { bundles, slots, torn, .. } = &mut **scratch;
        let torn = torn.bundles(lines);
        let Some(bundle) = bundles.first_mut() else {
            return;
        };
        let BundleScratch { chain, bends, .. } = bundle;
        let (gathered, gathered_mass) = (&mut bundle.position, &mut bundle.inverse_mass);
        let gathered_rest = &mut bundle.rest;
        let mut slots = slots[lines as usize].as_slice();
        for first in (0..number).step_by(side_by_side) {
            let lanes = side_by_side.min(number - first);
            let own;
            (own, slots) = slots.split_at(lanes * count);
            // Spare lanes keep their old values, which nothing reads.
            for (i, slots) in own.chunks_exact(lanes).enumerate() {
                for (lane, &slot) in slots.iter().enumerate() {
                    let (from, in_lane) = (slot as usize / LANES, slot as usize % LANES);
                    gathered[i].set(lane, position[from].get(in_lane));
                    gathered_mass[i][lane] = inverse_mass[from][in_lane];
                    if let Some(rest) = rest {
                        gathered_rest[i].set(lane, rest[from].get(in_lane));
                    }
                }
            }
            let (gaps, softness) = torn.of_bundle(first / side_by_side, count);
            let of_chains = CellColumn::new(gathered);
            let chains = Chains { position: of_chains, inverse_mass: gathered_mass, count, gaps, softness };
            // A diagonal belongs to one square alone.
            let is_edge = |lane| !lines.is_diagonal() && is_at_edge(first + lane, number);
            let rest = rest.map(|_| &**gathered_rest);
            solve_chains(simd, chains, (chain, bends), (solved, rest), is_edge, projection);
            for (i, slots) in own.chunks_exact(lanes).enumerate() {
                for (lane, &slot) in slots.iter().enumerate() {
                    position[slot as usize / LANES].set(slot as usize % LANES, gathered[i].get(lane));
                }
            }
        }
    }
}
