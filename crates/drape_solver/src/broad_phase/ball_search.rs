//! The search for faces near a ball, for the contacts of balls with cloth.
//!
//! Each step lists all faces that a ball can touch within it; in a substep the ball is near a few of these. On a grid
//! whose rows are rows of cells (`layout.rs`) the search need not test faces one by one. It takes the squares between
//! two rows lane by lane: first the box around all squares of a lane in that row, then, if the ball touches it, the box
//! of each square.
//!
//! ```text
//!   row r      0 1 2 3 | 4 5 6 7 | 8 ...      one box a lane: columns 0..=4, 4..=8, ...
//!   row r + 1  o-o-o-o-|-o-o-o-o-|-o          then one box a square: 0..=1, 1..=2, ...
//! ```
//!
//! The remaining faces are measured sixteen at a time, by the distance of their nearest points. On other bodies all
//! listed faces are measured.
//!
//! A face far from the ball matters too if the ball's centre has passed through it in this substep. It cannot be
//! farther away than face and ball have moved, so the search is widened by that distance.
//!
//! The search misses nothing that a test of every face would find: bounds are exact but for rounding, which is allowed
//! for, and the search is repeated as soon as pushes could have moved a face into reach.
//!
//! Design: `docs/design/ball_cloth.md`.

use core::ops::Range;

use glam::Vec3;

use crate::broad_phase::ball_search_lanes::{LongestTravel, Mark, Sift, SquareTest};
use crate::constants::{PASSING_SLACK, SEARCH_MARGIN};
use crate::simd::columns::LANES;
use crate::simd::isa::Isa;
use crate::simd::lanes::set_lanes;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::layout::{Grid, Layout};
use crate::state::topology::Topology;

/// The faces that balls can touch in a step, and the search for those near a ball.
#[derive(Clone, Debug, Default)]
pub(crate) struct BallSearch {
    /// The first `used` groups are in use; the others keep their memory.
    groups: Vec<CandidateGroup>,
    used: usize,
    /// For each cell of a body the lanes whose particles a ball can reach.
    marks: Vec<u16>,
    near: Near,
}

/// The candidates of one ball and one body.
#[derive(Clone, Debug, Default)]
struct CandidateGroup {
    pair: BallAndBody,
    /// Their range in the list of the step.
    candidates: Range<usize>,
    squares: Option<Squares>,
    /// For each square, row by row, in the order of slots: its first candidate and their number, packed.
    candidates_of: Vec<u32>,
    /// Slots of the candidates' corners; a segment repeats its second end. Empty if they are not known.
    corners: Vec<[u32; 3]>,
    /// A range of cells that holds all of these corners.
    cells: Range<usize>,
}

/// A ball and a body, by index in the island.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BallAndBody {
    pub ball: usize,
    pub body: usize,
}

/// A listed face or segment, by the slots of its corners.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Corners {
    Face([u32; 3]),
    Segment([u32; 2]),
}

/// Rows of squares on a grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Squares {
    pub grid: Grid,
    /// The first row, and the number of rows.
    pub first: usize,
    pub count: usize,
}

/// Bits of a packed entry that hold the number of candidates.
const COUNT_BITS: u32 = 2;

/// The result of the search of a group, and the progress of the round through it.
#[derive(Clone, Debug, Default)]
struct Near {
    group: usize,
    /// One bit for each candidate of the group, set if it may touch the ball.
    bits: Vec<u64>,
    /// Candidates of squares near the ball.
    around: Vec<u32>,
    /// The next candidate, by its number in the group.
    next: usize,
    /// Metres by which the search was wider than needed, less the pushes since; none before a search.
    margin: Option<f32>,
    /// For each cell of squares, the lanes that are near.
    masks: Vec<u16>,
}

impl BallSearch {
    /// Forgets the last step's candidates.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// Lists the faces and segments of a body that have a corner within `reach` (metres) of `centre`, by the slots of
    /// their corners, in order. `list` is called with each of them; `listed` is the number of candidates before.
    pub fn detect(
        &mut self,
        pair: BallAndBody,
        (centre, reach): (Vec3, f32),
        (body, isa): (&Body, Isa),
        listed: usize,
        mut list: impl FnMut(Corners),
    ) {
        let Self { groups, used, marks, .. } = self;
        let Body { particles, topology, .. } = body;
        marks.clear();
        isa.run(Mark { cells: &particles.position.cells, centre, reach, marks });
        if groups.len() == *used {
            groups.push(CandidateGroup::default());
        }
        let group = &mut groups[*used];
        *used += 1;
        group.pair = pair;
        group.candidates_of.clear();
        group.corners.clear();
        let mut count = 0;
        let mut list = |corners: Corners| -> usize {
            list(corners);
            count += 1;
            count - 1
        };
        group.squares = match &topology.layout {
            Layout::Grid(grid) if topology.has_faces_by_square && topology.layout.has_whole_rows() => {
                let CandidateGroup { candidates_of, corners, .. } = group;
                Some(list_squares(*grid, topology, marks, candidates_of, &mut |slots| {
                    corners.push(slots);
                    list(Corners::Face(slots))
                }))
            }
            layout => {
                let slot = |particle: u32| layout.slot(particle as usize) as u32;
                let is_near = |slots: &[u32]| slots.iter().any(|&slot| is_marked(marks, slot));
                for slots in topology.faces.iter().map(|face| face.map(slot)).filter(|slots| is_near(slots)) {
                    group.corners.push(slots);
                    list(Corners::Face(slots));
                }
                let segments = topology.segments.iter().map(|ends| ends.map(slot));
                for slots in segments.filter(|slots| is_near(slots)) {
                    group.corners.push([slots[0], slots[1], slots[1]]);
                    list(Corners::Segment(slots));
                }
                None
            }
        };
        let cells = || group.corners.iter().flatten().map(|&slot| slot as usize / LANES);
        group.cells = cells().min().unwrap_or(0)..cells().max().map_or(0, |last| last + 1);
        group.candidates = listed..listed + count;
    }

    /// Tests all candidates from now on: some were taken out of the list of the step, and `listed` are left.
    pub fn forget(&mut self, listed: usize) {
        self.groups.truncate(1);
        self.used = self.groups.len();
        if let Some(all) = self.groups.first_mut() {
            all.candidates = 0..listed;
            all.corners.clear();
        }
    }

    /// Starts a round through the candidates near balls.
    pub fn begin_round(&mut self) {
        self.near.group = 0;
        self.near.next = 0;
        self.near.margin = None;
    }

    /// The next candidate that may touch its ball now, by its index in the list of the step; none at the end of the
    /// round.
    pub fn next(&mut self, balls: &[Ball], bodies: &[Body], isa: Isa) -> Option<usize> {
        let Self { groups, used, near, .. } = self;
        while let Some(group) = groups[..*used].get(near.group) {
            if near.margin.is_none_or(|margin| margin < 0.0) {
                near.search(group, &balls[group.pair.ball], &bodies[group.pair.body], isa);
            }
            if let Some(candidate) = near.take(group) {
                return Some(group.candidates.start + candidate);
            }
            near.group += 1;
            near.next = 0;
            near.margin = None;
        }
        None
    }

    /// Records that a ball and particles have moved relative to each other by no more than `distance` metres.
    pub fn note_push(&mut self, distance: f32) {
        self.near.margin = self.near.margin.map(|margin| margin - distance);
    }
}

impl Near {
    /// Searches a group.
    fn search(&mut self, group: &CandidateGroup, ball: &Ball, body: &Body, isa: Isa) {
        let radius = ball.material.radius;
        // The first search has no margin, as mostly nothing is pushed at all.
        let margin = if self.margin.is_none() { 0.0 } else { SEARCH_MARGIN * radius };
        self.margin = Some(margin);
        let count = group.candidates.len();
        self.bits.clear();
        self.bits.resize(count.div_ceil(64), 0);
        self.around.clear();
        if group.corners.len() != count {
            self.bits.fill(u64::MAX);
            self.margin = Some(f32::INFINITY);
            return;
        }
        if count == 0 {
            return;
        }
        let Body { particles, context, settings, .. } = body;
        let centre = ball.position - particles.origin;
        let [position, displacement, integrated] =
            [&particles.position, &particles.displacement, &context.integrated]
                .map(|columns| &columns.cells[group.cells.clone()]);
        let way = isa.run(LongestTravel { position, displacement, integrated }) + ball.travel().length();
        // A push moves a face and also lengthens its way, so the margin counts twice.
        let reach_of_passage = PASSING_SLACK * radius + way + 2.0 * margin;
        let rounding = 1e-5 * (radius + centre.abs().max_element());
        let touch = reach_of_passage.max(radius + settings.thickness + margin) + rounding;
        let cells = &particles.position.cells;
        if let Some(squares) = group.squares {
            isa.run(SquareTest { cells, squares, centre, touch, masks: &mut self.masks });
            self.collect(group, squares);
        } else {
            self.around.extend(0..count as u32);
        }
        let Self { around, bits, .. } = self;
        isa.run(Sift { cells, corners: &group.corners, centre, touch, around, bits });
    }

    /// Collects the candidates of the squares that are near.
    fn collect(&mut self, group: &CandidateGroup, squares: Squares) {
        let width = squares.grid.width;
        for (row, masks) in self.masks.chunks(width).enumerate() {
            for (cell, &mask) in masks.iter().enumerate() {
                for lane in set_lanes(mask) {
                    let entry = group.candidates_of[(row * width + cell) * LANES + lane];
                    let first = entry >> COUNT_BITS;
                    self.around.extend(first..first + (entry & ((1 << COUNT_BITS) - 1)));
                }
            }
        }
    }

    /// The next candidate of the group that is near.
    fn take(&mut self, group: &CandidateGroup) -> Option<usize> {
        while self.next < group.candidates.len() {
            let word = self.next / 64;
            let left = self.bits[word] >> (self.next % 64);
            if left == 0 {
                self.next = (word + 1) * 64;
                continue;
            }
            let candidate = self.next + left.trailing_zeros() as usize;
            self.next = candidate + 1;
            return (candidate < group.candidates.len()).then_some(candidate);
        }
        None
    }
}

/// Sets the bit of a candidate.
#[inline(always)]
pub(crate) fn set(bits: &mut [u64], candidate: u32) {
    bits[candidate as usize / 64] |= 1 << (candidate % 64);
}

fn is_marked(marks: &[u16], slot: u32) -> bool {
    marks[slot as usize / LANES] & (1 << (slot as usize % LANES)) != 0
}

/// Lists the faces of all squares that have a marked corner, row by row.
fn list_squares(
    grid: Grid,
    topology: &Topology,
    marks: &[u16],
    candidates_of: &mut Vec<u32>,
    list: &mut impl FnMut([u32; 3]) -> usize,
) -> Squares {
    let width = grid.width;
    let row_of = |cell: usize| cell / width;
    let (first, last) = (marks.iter().position(|&mark| mark != 0), marks.iter().rposition(|&mark| mark != 0));
    let (Some(first), Some(last)) = (first, last) else {
        return Squares { grid, first: 0, count: 0 };
    };
    let rows = row_of(first).saturating_sub(1)..(row_of(last) + 1).min(grid.rows - 1);
    candidates_of.resize(rows.len() * width * LANES, 0);
    for row in rows.clone() {
        let around = |cell: usize| marks[row * width + cell] | marks[(row + 1) * width + cell];
        if (0..width).all(|cell| around(cell) == 0) {
            continue;
        }
        let (mut lane, mut cell) = (0, 0);
        // Columns in order: lane by lane.
        for column in 0..grid.columns - 1 {
            if cell == width {
                (lane, cell) = (lane + 1, 0);
            }
            let next = if cell + 1 < width { (lane, cell + 1) } else { (lane + 1, 0) };
            let is_near = |(lane, cell): (usize, usize)| around(cell) & (1 << lane) != 0;
            if is_near((lane, cell)) || is_near(next) {
                let slot =
                    |(lane, cell): (usize, usize), row: usize| ((row * width + cell) * LANES + lane) as u32;
                let upper = (grid.columns * row + column) as u32;
                let lower = upper + grid.columns as u32;
                let slots = [
                    slot((lane, cell), row),
                    slot(next, row),
                    slot((lane, cell), row + 1),
                    slot(next, row + 1),
                ];
                let entry = &mut candidates_of[((row - rows.start) * width + cell) * LANES + lane];
                let square = 2 * (row * (grid.columns - 1) + column);
                for face in &topology.faces[square..square + 2] {
                    let slots = face.map(|particle| match particle {
                        _ if particle == upper => slots[0],
                        _ if particle == upper + 1 => slots[1],
                        _ if particle == lower => slots[2],
                        _ => slots[3],
                    });
                    if slots.iter().any(|&slot| is_marked(marks, slot)) {
                        let candidate = list(slots) as u32;
                        if *entry == 0 {
                            *entry = candidate << COUNT_BITS;
                        }
                        *entry += 1;
                    }
                }
            }
            cell += 1;
        }
    }
    Squares { grid, first: rows.start, count: rows.len() }
}

/// True if the faces are those of a grid's squares, two for each, row by row.
pub(crate) fn are_by_square(faces: &[[u32; 3]], layout: &Layout) -> bool {
    let Layout::Grid(grid) = layout else { return false };
    let across = grid.columns - 1;
    faces.len() == 2 * across * (grid.rows - 1)
        && faces.iter().enumerate().all(|(index, face)| {
            let (column, row) = (index / 2 % across, index / 2 / across);
            face.iter().all(|&particle| {
                let (x, y) = (particle as usize % grid.columns, particle as usize / grid.columns);
                (column..=column + 1).contains(&x) && (row..=row + 1).contains(&y)
            })
        })
}
