//! The lines of a grid, their particles, and the way that they come into the lanes of a [line solve](crate::constraint::direct::line).
//!
//! ```text
//!   rows      columns    diagonals: each goes on at the other side,     antidiagonals
//!   o--o--o   o  o  o    and two ghosts cut it there                    lean to the left
//!   o--o--o   |  |  |      o.  o.  o.
//!   o--o--o   o  o  o        `o  `o  `->
//! ```
//!
//! Design: `docs/design/line_solves.md`.

use crate::constraint::direct::bundle::Direction;
use crate::constraint::direct::square_bundle::{SIDE, SquareLines};
use crate::simd::columns::{Cell, LANES};
use crate::state::bends::{BendScratch, BentGrid, BentThreads};
use crate::state::layout::{Grid, Layout};
use crate::state::membrane::{ElasticStick, Membrane};
use crate::state::settings::{BodySettings, StructuralSolve};
use crate::state::topology::{BatchSticks, StickBatch, StickKind, Topology};

/// The lines of all directions.
pub(super) const ALL_LINES: [Lines; 4] =
    [Lines::Diagonals, Lines::Antidiagonals, Lines::Columns, Lines::Rows];

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
    /// Columns to the right and rows down from a particle to the next one.
    pub fn offset(self) -> [isize; 2] {
        match self {
            Self::Rows => [1, 0],
            Self::Columns => [0, 1],
            Self::Diagonals => [1, 1],
            Self::Antidiagonals => [-1, 1],
        }
    }

    /// The lines along which this offset leads, in their direction or against it.
    pub fn along_offset(offset: [isize; 2]) -> Option<Self> {
        let back = offset.map(|way| -way);
        ALL_LINES.into_iter().find(|lines| [offset, back].contains(&lines.offset()))
    }

    /// The lines along which the sticks of `batch` lie. None if they join no neighbours of a grid, or are listed in a cloth without
    /// springs.
    pub fn along(batch: &StickBatch, topology: &Topology) -> Option<Self> {
        match &batch.sticks {
            BatchSticks::Grid { batch, .. } => {
                let (right, down) = batch.offset();
                Self::along_offset([right, down as isize])
            }
            // In a cloth with springs all sticks of a batch lie in one direction.
            _ if topology.membrane.is_some() => {
                let [a, b] = topology.stick(batch.first).map(|end| topology.place_in_grid(end as usize));
                let ([left, top], [column, row]) = (a?, b?);
                Self::along_offset([column - left, row - top])
            }
            _ => None,
        }
    }

    /// The lines that the sticks of `batch` form, if they are to be solved directly: springs, and structural sticks of a grid that lose
    /// all of their error at a `stiffness` per iteration, if the settings say so.
    pub fn of(
        batch: &StickBatch,
        stiffness: f32,
        topology: &Topology,
        settings: &BodySettings,
    ) -> Option<Self> {
        let lines = Self::along(batch, topology)?;
        let is_rigid = settings.structural == StructuralSolve::Lines
            && matches!(batch.sticks, BatchSticks::Grid { .. })
            && matches!(lines, Self::Rows | Self::Columns)
            && batch.material.kind == StickKind::Structural
            && stiffness >= 1.0;
        (is_rigid || lines.springs(topology).is_some()).then_some(lines)
    }

    /// The sticks of these lines; none if none are to be solved directly.
    pub fn sticks(self, topology: &Topology, stiffness: &[f32], settings: &BodySettings) -> Option<Solved> {
        self.springs(topology).map(Solved::Sticks).or_else(|| {
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

    /// The springs along these lines; none if their sticks are no springs.
    pub(super) fn springs(self, topology: &Topology) -> Option<ElasticStick> {
        let membrane = topology.membrane.as_ref()?;
        match self {
            Self::Rows => membrane.rows,
            Self::Columns => membrane.columns,
            Self::Diagonals | Self::Antidiagonals => membrane.diagonals,
        }
    }

    /// True for rows and columns, and for diagonals that are springs.
    pub(super) fn can_be_solved(self, topology: &Topology) -> bool {
        matches!(self, Self::Rows | Self::Columns) || self.springs(topology).is_some()
    }

    /// The bends of these lines; none if they do not resist.
    pub fn bends(self, topology: &Topology) -> Option<Solved> {
        let (threads, _) = self.bent_threads(topology)?;
        Some(Solved::Bends(threads.compliance_of_both()))
    }

    /// The weighted sums of these lines at rest, if friction holds them.
    pub fn rest<'a>(self, topology: &Topology, scratch: &'a BendScratch) -> Option<&'a [Cell]> {
        let (threads, direction) = self.bent_threads(topology)?;
        threads.slip.map(|_| &*scratch.rest[direction])
    }

    /// The threads along these lines, and their direction: 0 along rows, 1 along columns. None if they do not resist.
    fn bent_threads(self, topology: &Topology) -> Option<(BentThreads, usize)> {
        let direction = match self {
            Self::Rows => 0,
            Self::Columns => 1,
            Self::Diagonals | Self::Antidiagonals => return None,
        };
        Some((topology.bends.lines?.threads[direction]?, direction))
    }

    /// The direction of lines that bundles take where they lie; none for diagonals, which are gathered.
    pub(super) fn direction(self) -> Option<Direction> {
        match self {
            Self::Rows => Some(Direction::Rows),
            Self::Columns => Some(Direction::Columns),
            Self::Diagonals | Self::Antidiagonals => None,
        }
    }

    /// The number of lines, and of places in a line.
    pub(super) fn size(self, RuledGrid { columns, rows, .. }: RuledGrid) -> (usize, usize) {
        match self {
            Self::Rows => (rows, columns),
            Self::Columns => (columns, rows),
            Self::Diagonals | Self::Antidiagonals => (columns, rows + 2 * (rows - 1).div_ceil(columns)),
        }
    }

    /// The number of places in a line with the ghosts behind it.
    pub(super) fn places_with_ghosts(self, grid: RuledGrid) -> usize {
        match (self, grid.patches) {
            (Self::Rows, Some(patches)) => patches.across * patches.width,
            (Self::Columns, Some(patches)) => patches.down * patches.height,
            _ => self.size(grid).1,
        }
    }

    pub(super) fn storage(self, grid: RuledGrid) -> LineStorage {
        let Some(direction) = self.direction() else {
            return LineStorage::Gathered;
        };
        match (grid.patches, direction) {
            _ if self.size(grid).0 < LEAST_BUNDLED_LINES => LineStorage::Lone,
            (Some(Grid { down: 1, .. }), Direction::Rows) => LineStorage::Transposed,
            (Some(patches @ Grid { down: 1, .. }), Direction::Columns) => LineStorage::InPlace(patches),
            (Some(patches @ Grid { across: SIDE, down: SIDE, .. }), direction) => {
                LineStorage::Shuffled(SquareLines::new(direction, patches))
            }
            _ => LineStorage::Gathered,
        }
    }

    /// The number of bundles in which the lines are solved.
    pub(super) fn bundles(self, grid: RuledGrid) -> usize {
        match self.storage(grid) {
            LineStorage::InPlace(patches) => patches.width,
            LineStorage::Shuffled(lines) => lines.bundles(),
            LineStorage::Transposed | LineStorage::Gathered | LineStorage::Lone => {
                self.size(grid).0.div_ceil(LANES)
            }
        }
    }

    /// The bundle in which a line is solved, and its lane.
    pub(super) fn bundle_of(self, grid: RuledGrid, line: usize) -> (usize, usize) {
        match self.storage(grid) {
            LineStorage::InPlace(patches) => (line % patches.width, line / patches.width),
            LineStorage::Shuffled(lines) => lines.bundle_of(line),
            LineStorage::Transposed | LineStorage::Gathered | LineStorage::Lone => {
                (line / LANES, line % LANES)
            }
        }
    }

    /// The line through the particle in this column and row, and the place of the particle in it: the inverse of
    /// [`places`](Self::places).
    pub(super) fn line_and_place(self, grid: RuledGrid, [column, row]: [usize; 2]) -> [usize; 2] {
        let RuledGrid { columns, .. } = grid;
        let from_the_left = match self {
            Self::Rows => return [row, column],
            Self::Columns => return [column, row],
            Self::Diagonals => column,
            Self::Antidiagonals => columns - 1 - column,
        };
        let line = (from_the_left + columns - row % columns) % columns;
        // Two ghosts each time that the line has gone on at the other side.
        [line, row + 2 * ((line + row) / columns)]
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
                        && (line + row).is_multiple_of(columns)
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
pub(super) const GHOST: u32 = 1 << 31;

/// The resistance of lines that are solved directly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solved {
    /// Sticks, with their compliance in m/N.
    Sticks(ElasticStick),
    /// Bends of this compliance inside the cloth, in m/N.
    Bends(f32),
}

impl Solved {
    /// Springs that resist half as much. None for rigid sticks, and for bends.
    pub fn half(self) -> Option<Self> {
        match self {
            Self::Sticks(stick) if stick.compliance > 0.0 => {
                Some(Self::Sticks(ElasticStick { compliance: 2.0 * stick.compliance, ..stick }))
            }
            Self::Sticks(_) | Self::Bends(_) => None,
        }
    }
}

/// A grid of particles, by rows and columns: in patches, or in order if it is too small for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RuledGrid {
    pub columns: usize,
    pub rows: usize,
    pub patches: Option<Grid>,
}

impl RuledGrid {
    fn in_patches(patches: Grid) -> Self {
        Self { columns: patches.columns, rows: patches.rows, patches: Some(patches) }
    }

    /// The grid of a topology. Some of its places may be empty if it is torn.
    pub fn of(topology: &Topology) -> Option<Self> {
        let small = || {
            let bent = topology.bends.lines.map(|BentGrid { columns, rows, .. }| [columns, rows]);
            bent.or_else(|| topology.membrane.and_then(|Membrane { size, .. }| size))
        };
        match &topology.layout {
            &Layout::Grid(grid) => Some(Self::in_patches(grid)),
            Layout::Linear { .. } | Layout::Renumbered(_) => {
                small().map(|[columns, rows]| Self { columns, rows, patches: None })
            }
            Layout::Torn(torn) => Some(Self::in_patches(torn.grid)),
        }
    }
}

/// The way that lines come into the lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LineStorage {
    /// Columns of patches side by side: each is in a lane already.
    InPlace(Grid),
    /// Rows of patches side by side: they run through all lanes.
    Transposed,
    /// Rows or columns of patches four by four.
    Shuffled(SquareLines),
    /// Lines that run through some of the lanes.
    Gathered,
    /// Solved one by one, because there are too few of them.
    Lone,
}

/// Least number of lines that are solved side by side.
const LEAST_BUNDLED_LINES: usize = 4;

/// The slots of the particles of all lines that must be gathered.
pub(super) fn slots(layout: &Layout, grid: RuledGrid, lines: Lines) -> Vec<u32> {
    let lanes = match lines.storage(grid) {
        LineStorage::Gathered => LANES,
        LineStorage::Lone => 1,
        LineStorage::InPlace(_) | LineStorage::Transposed | LineStorage::Shuffled(_) => return Vec::new(),
    };
    let (number, count) = lines.size(grid);
    let bundles = (0..number).step_by(lanes).map(move |first| first..number.min(first + lanes));
    let of_place = |index: usize| match grid.patches {
        Some(patches) => patches.slot(index % patches.columns, index / patches.columns),
        None => layout.slot(index),
    };
    let slot = |place: LinePlace| of_place(place.index) as u32 | if place.is_ghost { GHOST } else { 0 };
    let mut slots = Vec::with_capacity(number * count);
    for bundle in bundles {
        let all: Vec<_> = bundle.map(|line| lines.places(grid, line)).collect();
        slots.extend((0..count).flat_map(|i| all.iter().map(move |places| slot(places[i]))));
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_particle_is_found_in_its_lines() {
        for (columns, rows) in [(5, 9), (9, 5), (2, 7), (4, 4), (3, 2)] {
            let grid = RuledGrid { columns, rows, patches: None };
            for lines in ALL_LINES {
                let (number, count) = lines.size(grid);
                let mut found = 0;
                for line in 0..number {
                    let places = lines.places(grid, line);
                    assert_eq!(places.len(), count);
                    for (place, _) in places.iter().enumerate().filter(|(_, place)| !place.is_ghost) {
                        let index = places[place].index;
                        let at = lines.line_and_place(grid, [index % columns, index / columns]);
                        assert_eq!(at, [line, place], "{lines:?} of {columns} x {rows}");
                        found += 1;
                    }
                }
                assert_eq!(found, columns * rows, "{lines:?}");
            }
        }
    }
}
