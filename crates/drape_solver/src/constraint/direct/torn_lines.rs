//! The lines of a torn grid: those of the grid have gaps, and copies of particles are in lines of their own.
//!
//! ```text
//!   o--o--o--o--o--o     A stick that is not there pulls at nothing, so one solve takes the parts on both sides of a gap:
//!       \gap       \     the matrix falls into two blocks there. Loose sticks that follow each other, from copy to copy,
//!         c--c--c--c     are solved one line after another.
//! ```
//!
//! Design: `docs/design/line_solves.md`.

use std::sync::{Arc, Weak};

use crate::constraint::direct::grid_lines::{LineStorage, Lines, RuledGrid};
use crate::simd::columns::LANES;
use crate::state::layout::Layout;
use crate::state::topology::{BatchSticks, Topology};
use crate::state::torn_grid::TornGrid;

/// The number of particles of a line of the grid that loose sticks take along at each of their ends: its pull then moves them
/// together. One alone would give way.
const REACH: usize = 4;

/// What sets the rows and columns of a torn grid apart from those of a whole one.
#[derive(Clone, Debug, Default)]
pub(super) struct TornLines {
    along: [TornDirection; 2],
    /// The topology from which they follow.
    topology: Weak<Topology>,
}

/// The same in one direction.
#[derive(Clone, Debug, Default)]
struct TornDirection {
    /// For each bundle of lines that are solved side by side, and each place in these: bit mask of the lanes without a stick
    /// to the next place, lane 0 in the lowest bit. Empty if the grid is whole.
    gaps: Vec<u16>,
    /// Slots of the particles along loose sticks, line after line.
    slots: Vec<u32>,
    /// The ends of these lines in `slots`.
    ends: Vec<usize>,
}

impl TornLines {
    /// Lists gaps and loose lines, and returns true, unless they are listed for this topology.
    pub fn note(&mut self, topology: &Arc<Topology>, grid: RuledGrid) -> bool {
        if core::ptr::eq(self.topology.as_ptr(), Arc::as_ptr(topology)) {
            return false;
        }
        self.topology = Arc::downgrade(topology);
        for (own, lines) in self.along.iter_mut().zip([Lines::Rows, Lines::Columns]) {
            own.gaps.clear();
            own.slots.clear();
            own.ends.clear();
            if let Layout::Torn(torn) = &topology.layout {
                own.note_gaps(topology, grid, lines);
                own.note_loose(topology, torn, grid, lines);
            }
        }
        true
    }

    fn direction(&self, lines: Lines) -> Option<&TornDirection> {
        match lines {
            Lines::Rows => Some(&self.along[0]),
            Lines::Columns => Some(&self.along[1]),
            Lines::Diagonals | Lines::Antidiagonals => None,
        }
    }

    /// The gaps along these lines, bundle after bundle; none if the grid is whole.
    pub fn gaps(&self, lines: Lines) -> Option<&[u16]> {
        self.direction(lines).map(|own| &*own.gaps).filter(|gaps| !gaps.is_empty())
    }

    /// The slots of each line of loose sticks in this direction.
    pub fn loose(&self, lines: Lines) -> impl Iterator<Item = &[u32]> {
        self.direction(lines).into_iter().flat_map(|own| {
            let starts = core::iter::once(0).chain(own.ends.iter().copied());
            starts.zip(&own.ends).map(|(start, &end)| &own.slots[start..end])
        })
    }

    /// The number of particles in the longest line of loose sticks.
    pub fn longest(&self) -> usize {
        let longest = |lines| self.loose(lines).map(<[u32]>::len).max().unwrap_or_default();
        longest(Lines::Rows).max(longest(Lines::Columns))
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let bytes = |TornDirection { gaps, slots, ends }: &TornDirection| {
            size_of_val(&**gaps) + size_of_val(&**slots) + size_of_val(&**ends)
        };
        self.along.iter().map(bytes).sum()
    }
}

impl TornDirection {
    fn note_gaps(&mut self, topology: &Topology, grid: RuledGrid, lines: Lines) {
        let (number, count) = lines.size(grid);
        let bundles = match lines.storage(grid) {
            LineStorage::InPlace => grid.patches.map_or(0, |patches| patches.width),
            LineStorage::Transposed | LineStorage::Gathered => number.div_ceil(LANES),
            LineStorage::Lone => number,
        };
        self.gaps.resize(bundles * count, u16::MAX);
        for batch in &topology.batches {
            let BatchSticks::Grid { batch: half, severed, .. } = &batch.sticks else { continue };
            if half.offset() != offset(lines) {
                continue;
            }
            let mut severed = severed.iter().peekable();
            for stick in 0..half.count() {
                if severed.next_if_eq(&&(stick as u32)).is_none() {
                    let [line, place] = line_and_place(lines, half.start(stick));
                    let (bundle, lane) = lines.bundle_of(grid, line);
                    self.gaps[bundle * count + place] &= !(1 << lane);
                }
            }
        }
    }

    /// Lists the loose sticks that are as long as those of the grid, in lines as long as may be.
    fn note_loose(&mut self, topology: &Topology, torn: &TornGrid, grid: RuledGrid, lines: Lines) {
        let of_grid = topology.batches.iter().find_map(|batch| match batch.sticks {
            BatchSticks::Grid { batch: half, rest_length, .. } if half.offset() == offset(lines) => {
                Some((batch.material, rest_length))
            }
            _ => None,
        });
        let Some((material, rest_length)) = of_grid else {
            return;
        };
        let mut sticks = Vec::new();
        for batch in topology.batches.iter().filter(|batch| batch.material == material) {
            let BatchSticks::Loose(loose) = &batch.sticks else { continue };
            for stick in loose.iter().filter(|stick| stick.rest_length == rest_length) {
                let ends = stick.slots.map(|slot| {
                    let home = torn.index(slot as usize).map_or(slot, |index| torn.home(index));
                    (line_and_place(lines, torn.grid.place(home as usize)), slot)
                });
                let [(from, a), (to, b)] = if ends[0] <= ends[1] { ends } else { [ends[1], ends[0]] };
                if to == [from[0], from[1] + 1] {
                    sticks.push((from, [a, b]));
                }
            }
        }
        sticks.sort_unstable();
        let mut chains: Vec<Vec<u32>> = Vec::new();
        for of_line in sticks.chunk_by(|p, q| p.0[0] == q.0[0]) {
            let first = chains.len();
            for &(_, [a, b]) in of_line {
                match chains[first..].iter_mut().find(|chain| chain.last() == Some(&a)) {
                    Some(chain) => chain.push(b),
                    None => chains.push(vec![a, b]),
                }
            }
        }
        for chain in chains {
            if let (Some(&first), Some(&last)) = (chain.first(), chain.last()) {
                let before = self.beyond(torn, grid, lines, first, -1);
                let after = self.beyond(torn, grid, lines, last, 1);
                self.slots.extend(before.into_iter().rev().chain(chain).chain(after));
                self.ends.push(self.slots.len());
            }
        }
    }

    /// The slots of the next particles of the grid's line, before or behind the one in `slot`, up to a gap.
    fn beyond(&self, torn: &TornGrid, grid: RuledGrid, lines: Lines, slot: u32, step: isize) -> Vec<u32> {
        let (_, count) = lines.size(grid);
        let mut slots = Vec::new();
        let is_home = torn.index(slot as usize).is_some_and(|index| torn.home(index) == slot);
        if !is_home {
            return slots;
        }
        let [line, mut place] = line_and_place(lines, torn.grid.place(slot as usize));
        let (bundle, lane) = lines.bundle_of(grid, line);
        while slots.len() < REACH {
            let Some(next) = place.checked_add_signed(step).filter(|&next| next < count) else { break };
            if self.gaps[bundle * count + place.min(next)] & (1 << lane) != 0 {
                break;
            }
            place = next;
            // `line_and_place` is its own inverse.
            let [column, row] = line_and_place(lines, [line, place]);
            slots.push(torn.grid.slot(column, row) as u32);
        }
        slots
    }
}

/// Columns to the right and rows down to the next particle of a line.
fn offset(lines: Lines) -> (isize, usize) {
    if lines == Lines::Rows { (1, 0) } else { (0, 1) }
}

/// The line of a column and row, and the place in it.
fn line_and_place(lines: Lines, [column, row]: [usize; 2]) -> [usize; 2] {
    if lines == Lines::Rows { [row, column] } else { [column, row] }
}
