//! Gaps in lines: those of a torn grid have some, and copies of its particles are in lines of their own. Diagonals always have gaps, at the
//! sides of the grid.
//!
//! ```text
//!   o--o--o--o--o--o     A stick that is not there pulls at nothing, so one solve takes the parts on both sides of a gap:
//!       \gap       \     the matrix falls into two blocks there. Loose sticks that follow each other, from copy to copy,
//!         c--c--c--c     are solved one line after another.
//! ```
//!
//! Design: `docs/design/line_solves.md`.

use std::sync::{Arc, Weak};

use crate::constraint::direct::bundle::TornBundles;
use crate::constraint::direct::grid_lines::{ALL_LINES, Lines, RuledGrid};
use crate::constraint::direct::line_storage::LineStorage;
use crate::constraint::direct::strip_widths::StripWidths;
use crate::simd::columns::LANES;
use crate::state::grid::GridBatch;
use crate::state::layout::Layout;
use crate::state::topology::{BatchSticks, StickBatch, Topology};

/// The number of particles of a line of the grid that rigid loose sticks take along at each of their ends: its pull then moves them
/// together. One alone would give way.
const REACH: usize = 4;

/// The gaps in the lines of a grid, and what else a torn grid has in place of its lines.
#[derive(Clone, Debug, Default)]
pub(super) struct TornLines {
    along: [TornDirection; 4],
    /// The topology from which they follow.
    topology: Weak<Topology>,
}

/// The same in one direction.
#[derive(Clone, Debug, Default)]
struct TornDirection {
    /// For each bundle of lines that are solved side by side, and each place in these: bit mask of the lanes without a stick
    /// to the next place, lane 0 in the lowest bit. Empty if all have theirs, or if the grid has too few lines for a bundle.
    gaps: Vec<u16>,
    /// The compliance of these sticks, in parts of that inside the cloth. Empty if they are no springs.
    softness: Vec<[f32; LANES]>,
    lone: LineList,
}

/// Lines that are solved one after another.
#[derive(Clone, Debug, Default)]
struct LineList {
    /// Slots of the particles.
    slots: Vec<u32>,
    /// For each particle the compliance of its stick to the next one, in parts of that inside the cloth. Empty if they are no springs.
    softness: Vec<f32>,
    /// The ends of the lines in `slots`.
    ends: Vec<usize>,
}

/// A line that is solved by itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoneLine<'a> {
    /// Slots of its particles.
    pub slots: &'a [u32],
    /// For each particle the compliance of its stick to the next one, in parts of that inside the cloth; none if they are no springs.
    pub softness: Option<&'a [f32]>,
}

/// A stick from one particle of a line to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Link {
    /// Lines in the same direction have different numbers.
    line: isize,
    /// The column or row in which it begins.
    place: isize,
    slots: [u32; 2],
}

impl TornLines {
    /// Lists gaps and loose lines, and returns true, unless they are listed for this topology. `grid` is its grid, or what is left of it.
    pub fn note(&mut self, topology: &Arc<Topology>, grid: Option<RuledGrid>) -> bool {
        if core::ptr::eq(self.topology.as_ptr(), Arc::as_ptr(topology)) {
            return false;
        }
        self.topology = Arc::downgrade(topology);
        let is_torn = topology.is_torn_grid();
        let widths = (is_torn && topology.has_membrane()).then(|| StripWidths::of(topology));
        for lines in ALL_LINES {
            let own = &mut self.along[lines as usize];
            *own = TornDirection::default();
            if (is_torn || lines.is_diagonal()) && lines.can_be_solved(topology) {
                let widths = widths.as_ref().filter(|_| lines.springs(topology).is_some());
                own.note(topology, grid, lines, widths);
            }
        }
        true
    }

    /// The gaps of these lines, and their softness, where they are solved side by side.
    pub fn bundles(&self, lines: Lines) -> TornBundles<'_> {
        let TornDirection { gaps, softness, .. } = &self.along[lines as usize];
        TornBundles {
            gaps: Some(&**gaps).filter(|gaps| !gaps.is_empty()),
            softness: Some(&**softness).filter(|softness| !softness.is_empty()),
        }
    }

    /// Each line in this direction that no bundle takes.
    pub fn lone(&self, lines: Lines) -> impl Iterator<Item = LoneLine<'_>> {
        let LineList { slots, softness, ends } = &self.along[lines as usize].lone;
        let starts = core::iter::once(0).chain(ends.iter().copied());
        starts
            .zip(ends)
            .map(|(start, &end)| LoneLine { slots: &slots[start..end], softness: softness.get(start..end) })
    }

    /// The number of particles in the longest line that no bundle takes.
    pub fn longest(&self) -> usize {
        let longest = |lines| self.lone(lines).map(|line| line.slots.len()).max().unwrap_or_default();
        ALL_LINES.into_iter().map(longest).max().unwrap_or_default()
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let bytes = |TornDirection { gaps, softness, lone }: &TornDirection| {
            let of_lone = size_of_val(&*lone.slots) + size_of_val(&*lone.softness) + size_of_val(&*lone.ends);
            size_of_val(&**gaps) + size_of_val(&**softness) + of_lone
        };
        self.along.iter().map(bytes).sum()
    }
}

impl TornDirection {
    fn note(
        &mut self,
        topology: &Topology,
        grid: Option<RuledGrid>,
        lines: Lines,
        widths: Option<&StripWidths>,
    ) {
        let bundled = grid.filter(|&grid| LineStorage::of(lines, grid) != LineStorage::Lone);
        if let Some(grid) = bundled {
            self.note_ends(grid, lines);
        }
        if !topology.is_torn_grid() {
            return;
        }
        if let Some(grid) = bundled {
            self.note_sticks(topology, grid, lines, widths);
        }
        let links = links(topology, lines, bundled.is_none());
        for mut chain in chains(&links) {
            if let (Some(grid), None) = (bundled, widths) {
                self.reach_out(topology, grid, lines, &mut chain);
            }
            let LineList { slots, softness, ends } = &mut self.lone;
            if let Some(widths) = widths {
                softness.extend(chain.windows(2).map(|ends| widths.softness(lines, [ends[0], ends[1]])));
                softness.push(1.0);
            }
            slots.extend(chain);
            ends.push(slots.len());
        }
    }

    /// Makes room for gaps, and notes those of diagonals at the sides of the grid, where they go on at the other side.
    fn note_ends(&mut self, grid: RuledGrid, lines: Lines) {
        let (number, count) = lines.size(grid);
        let storage = LineStorage::of(lines, grid);
        self.gaps.resize(storage.bundles(number) * count, 0);
        if !lines.is_diagonal() {
            return;
        }
        for [line, place] in (0..number).flat_map(|line| (0..count).map(move |place| [line, place])) {
            if !lines.has_stick(grid, [line, place]) {
                let (bundle, lane) = storage.bundle_of(line);
                self.gaps[bundle * count + place] |= 1 << lane;
            }
        }
    }

    /// Notes the gaps of lines of a torn grid, and what has become softer.
    fn note_sticks(
        &mut self,
        topology: &Topology,
        grid: RuledGrid,
        lines: Lines,
        widths: Option<&StripWidths>,
    ) {
        let (_, count) = lines.size(grid);
        let storage = LineStorage::of(lines, grid);
        let cell_and_lane = |start: [usize; 2]| {
            let [line, place] = lines.line_and_place(grid, start);
            let (bundle, lane) = storage.bundle_of(line);
            (bundle * count + place, lane)
        };
        for half in halves(topology, lines) {
            let own = topology.batches.iter().find_map(|batch| match &batch.sticks {
                BatchSticks::Grid { batch, severed, .. } if *batch == half => Some(severed),
                _ => None,
            });
            // A half that has lost all its sticks has no batch.
            let all = if own.is_none() { 0..half.count() } else { 0..0 };
            let severed = own.into_iter().flatten().map(|&stick| stick as usize);
            for stick in severed.chain(all) {
                let (cell, lane) = cell_and_lane(half.start(stick));
                self.gaps[cell] |= 1 << lane;
            }
        }
        if let (Some(widths), Layout::Torn(torn)) = (widths, &topology.layout) {
            self.softness.resize(self.gaps.len(), [1.0; LANES]);
            for [from, to] in widths.other_than_inside(lines, torn.grid) {
                let (cell, lane) = cell_and_lane(torn.grid.place(from as usize));
                self.softness[cell][lane] = widths.softness(lines, [from, to]);
            }
        }
    }

    /// Adds the particles of the grid's line before and behind a chain, up to gaps.
    fn reach_out(&self, topology: &Topology, grid: RuledGrid, lines: Lines, chain: &mut Vec<u32>) {
        let Layout::Torn(torn) = &topology.layout else { return };
        let (_, count) = lines.size(grid);
        let beyond = |slot: u32, step: isize| {
            let mut slots = Vec::new();
            let is_home = torn.index(slot as usize).is_some_and(|index| torn.home(index) == slot);
            if !is_home {
                return slots;
            }
            let [line, mut place] = lines.line_and_place(grid, torn.grid.place(slot as usize));
            let (bundle, lane) = LineStorage::of(lines, grid).bundle_of(line);
            while slots.len() < REACH {
                let Some(next) = place.checked_add_signed(step).filter(|&next| next < count) else { break };
                if self.gaps[bundle * count + place.min(next)] & (1 << lane) != 0 {
                    break;
                }
                place = next;
                let [column, row] = lines.column_and_row(grid, [line, place]);
                slots.push(torn.grid.slot(column, row) as u32);
            }
            slots
        };
        if let (Some(&first), Some(&last)) = (chain.first(), chain.last()) {
            let mut before = beyond(first, -1);
            before.reverse();
            chain.splice(0..0, before);
            chain.extend(beyond(last, 1));
        }
    }
}

/// The two halves of the family of a torn grid that lie along these lines.
fn halves(topology: &Topology, lines: Lines) -> impl Iterator<Item = GridBatch> {
    let [right, down] = lines.offset();
    let grid = topology.layout.grid();
    grid.into_iter().flat_map(move |grid| GridBatch::halves(grid, right, down.unsigned_abs()))
}

/// The sticks along these lines that no bundle takes, in order: loose and listed ones, or `all`.
fn links(topology: &Topology, lines: Lines, all: bool) -> Vec<Link> {
    let is_spring = lines.springs(topology).is_some();
    let is_family = |batch: &StickBatch| matches!(batch.sticks, BatchSticks::Grid { .. });
    let is_along = |batch: &StickBatch| is_family(batch) && Lines::along(batch, topology) == Some(lines);
    let family = topology.batches.iter().find(|batch| is_along(batch));
    let family = family.map(|batch| (batch.material, topology.rest_length(batch.first)));
    let links = topology.batches.iter().flat_map(|batch| {
        let is_own = !is_family(batch) || all && is_along(batch);
        let is_alike =
            move |&stick: &usize| is_spring || family == Some((batch.material, topology.rest_length(stick)));
        let sticks = if is_own { batch.range() } else { 0..0 };
        sticks.filter(is_alike).filter_map(|stick| Link::new(topology, lines, stick))
    });
    let mut links: Vec<Link> = links.collect();
    links.sort_unstable();
    links
}

impl Link {
    /// A stick, if it lies along these lines.
    fn new(topology: &Topology, lines: Lines, stick: usize) -> Option<Self> {
        let ends = topology.stick(stick);
        let [a, b] = ends.map(|end| topology.place_in_grid(end as usize));
        let ([from, to], slots) = ([a?, b?], topology.stick_slots(stick).map(|slot| slot as u32));
        let is_step = |[from, to]: [[isize; 2]; 2]| [to[0] - from[0], to[1] - from[1]] == lines.offset();
        let ([column, row], slots) = if is_step([from, to]) {
            (from, slots)
        } else if is_step([to, from]) {
            (to, [slots[1], slots[0]])
        } else {
            return None;
        };
        let [line, place] = match lines {
            Lines::Rows => [row, column],
            Lines::Columns => [column, row],
            Lines::Diagonals => [column - row, row],
            Lines::Antidiagonals => [column + row, row],
        };
        Some(Self { line, place, slots })
    }
}

/// The slots along links that follow each other, in chains as long as may be.
fn chains(links: &[Link]) -> Vec<Vec<u32>> {
    let mut chains: Vec<Vec<u32>> = Vec::new();
    for of_line in links.chunk_by(|p, q| p.line == q.line) {
        let first = chains.len();
        for &Link { slots: [a, b], .. } in of_line {
            match chains[first..].iter_mut().find(|chain| chain.last() == Some(&a)) {
                Some(chain) => chain.push(b),
                None => chains.push(vec![a, b]),
            }
        }
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::{ClothBuilder, ClothMaterial};
    use crate::state::membrane::MembraneStiffness;
    use crate::state::settings::BodySettings;

    /// Patches side by side with and without ghosts, four by four, one below the other, and a grid without patches.
    #[test]
    fn diagonals_end_at_the_sides_of_a_whole_grid() {
        for (columns, rows) in [(40, 20), (64, 70), (9, 12), (3, 40), (6, 5)] {
            let membrane_stiffness = MembraneStiffness::balanced(100.0, 5.0);
            let material = ClothMaterial { membrane_stiffness, ..ClothMaterial::default() };
            let cloth = ClothBuilder::new(1.0, 1.0, columns, rows).material(material);
            let body = cloth.build(BodySettings::default()).expect("valid");
            let grid = RuledGrid::of(&body.topology).expect("a grid");
            let mut found = TornLines::default();
            assert!(found.note(&body.topology, Some(grid)));
            assert_eq!(found.longest(), 0, "no line is loose");
            for lines in ALL_LINES {
                let gaps = found.bundles(lines).gaps;
                if !lines.is_diagonal() {
                    assert!(gaps.is_none());
                    continue;
                }
                let gaps = gaps.expect("at the sides");
                let (number, count) = lines.size(grid);
                for (line, place) in (0..number).flat_map(|line| (0..count).map(move |place| (line, place))) {
                    let (bundle, lane) = LineStorage::of(lines, grid).bundle_of(line);
                    let is_gap = gaps[bundle * count + place] & (1 << lane) != 0;
                    assert_eq!(
                        is_gap,
                        !lines.has_stick(grid, [line, place]),
                        "{lines:?} of {columns} x {rows}: {line}, {place}"
                    );
                }
            }
        }
    }
}
