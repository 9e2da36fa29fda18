//! The lines of a grid, and their particles.
//!
//! ```text
//!   rows      columns    diagonals: each goes on at the other side,     antidiagonals
//!   o--o--o   o  o  o    with a gap there                               lean to the left
//!   o--o--o   |  |  |      o.  o.  o.
//!   o--o--o   o  o  o        `o  `o  `->
//! ```
//!
//! Design: `docs/design/line_solves.md`.

use core::ops::Range;

use crate::simd::columns::Cell;
use crate::state::bends::{BendScratch, BentGrid, BentThreads};
use crate::state::layout::{Grid, Layout};
use crate::state::membrane::{ElasticStick, Membrane};
use crate::state::particles::Particles;
use crate::state::settings::{BodySettings, StructuralSolve};
use crate::state::topology::{BatchSticks, StickBatch, StickKind, Topology};

/// The iterations in which sticks are relaxed. With rigid lines that is the last one alone: sweeps over the other sticks in those
/// before would put the lines out of place again. Joints need them all, to know which way they are pulled (`docs/design/joints.md`).
pub(crate) fn stick_iterations(
    particles: &Particles,
    topology: &Topology,
    settings: &BodySettings,
) -> Range<u32> {
    let mut batches = topology.batches.iter();
    let has_lines =
        batches.any(|batch| Lines::are_rigid(batch, batch.material.stiffness, topology, settings));
    let first = if has_lines && particles.joints.is_empty() { settings.iterations - 1 } else { 0 };
    first..settings.iterations
}

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

    /// True for lines that lie aslant.
    pub fn is_diagonal(self) -> bool {
        matches!(self, Self::Diagonals | Self::Antidiagonals)
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
        let are_solved =
            Self::are_rigid(batch, stiffness, topology, settings) || lines.springs(topology).is_some();
        are_solved.then_some(lines)
    }

    /// True if the sticks of `batch` form rigid lines, and the settings say that these are to be solved directly. A rope with self-contact
    /// is swept, as lines pull harder than contacts push.
    pub fn are_rigid(
        batch: &StickBatch,
        stiffness: f32,
        topology: &Topology,
        settings: &BodySettings,
    ) -> bool {
        settings.structural == StructuralSolve::Lines
            && !(topology.is_rope() && settings.has_self_contact())
            && matches!(batch.sticks, BatchSticks::Grid { .. })
            && batch.material.kind == StickKind::Structural
            && stiffness >= 1.0
            && Self::along(batch, topology)
                .is_some_and(|lines| !lines.is_diagonal() && lines.springs(topology).is_none())
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
        !self.is_diagonal() || self.springs(topology).is_some()
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

    /// The number of lines, and of places in a line.
    ///
    /// Diagonals go on at the other side of the grid, so that all have a place in each row.
    pub(super) fn size(self, grid: RuledGrid) -> (usize, usize) {
        let RuledGrid { columns, rows, .. } = grid;
        match self {
            Self::Rows => (rows, columns),
            Self::Columns => (columns, rows),
            Self::Diagonals | Self::Antidiagonals => (grid.around(), rows),
        }
    }

    /// The line through the particle in this column and row, and the place of the particle in it.
    pub(super) fn line_and_place(self, grid: RuledGrid, [column, row]: [usize; 2]) -> [usize; 2] {
        let around = grid.around();
        match self {
            Self::Rows => [row, column],
            Self::Columns => [column, row],
            Self::Diagonals => [(column + around - row % around) % around, row],
            Self::Antidiagonals => [(column + row) % around, row],
        }
    }

    /// The column and row of a place in a line: the inverse of [`line_and_place`](Self::line_and_place). Diagonals have places
    /// beside the grid where its patches have.
    pub(super) fn column_and_row(self, grid: RuledGrid, [line, place]: [usize; 2]) -> [usize; 2] {
        match self {
            Self::Rows => [place, line],
            Self::Columns => [line, place],
            Self::Diagonals => Self::Antidiagonals.line_and_place(grid, [line, place]),
            Self::Antidiagonals => Self::Diagonals.line_and_place(grid, [line, place]),
        }
    }

    /// True if a line leads from this place to the next one within the grid: diagonals have a gap where they go on at the other side.
    pub(super) fn has_stick(self, grid: RuledGrid, [line, place]: [usize; 2]) -> bool {
        let (_, count) = self.size(grid);
        let [column, _] = self.column_and_row(grid, [line, place]);
        let next = column.checked_add_signed(self.offset()[0]);
        place + 1 < count && column < grid.columns && next.is_some_and(|next| next < grid.columns)
    }
}

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
    /// The number of columns after which a diagonal goes on at the other side: where patches lie side by side, their ghosts count too.
    fn around(self) -> usize {
        match self.patches {
            Some(Grid { across, width, down: 1, .. }) => across * width,
            _ => self.columns,
        }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_particle_is_found_in_its_lines() {
        for (columns, rows) in [(5, 9), (9, 5), (2, 7), (4, 4), (3, 2), (40, 3)] {
            let grid =
                RuledGrid { columns, rows, patches: Grid::new(columns, rows).filter(|grid| grid.down == 1) };
            for lines in ALL_LINES {
                let (number, count) = lines.size(grid);
                let [right, down] = lines.offset();
                let (mut found, mut sticks) = (0, 0);
                for (line, place) in
                    (0..number).flat_map(|line| (0..count).map(move |place| [line, place])).map(Into::into)
                {
                    let at = lines.column_and_row(grid, [line, place]);
                    assert_eq!(
                        lines.line_and_place(grid, at),
                        [line, place],
                        "{lines:?} of {columns} x {rows}"
                    );
                    found += usize::from(at[0] < columns);
                    if lines.has_stick(grid, [line, place]) {
                        let next = [at[0].checked_add_signed(right), at[1].checked_add_signed(down)]
                            .map(Option::unwrap);
                        assert_eq!(lines.column_and_row(grid, [line, place + 1]), next);
                        sticks += 1;
                    }
                }
                assert_eq!(found, columns * rows, "{lines:?}");
                let [across, below] = [columns - right.unsigned_abs(), rows - down.unsigned_abs()];
                assert_eq!(sticks, across * below, "{lines:?} of {columns} x {rows}");
            }
        }
    }
}
