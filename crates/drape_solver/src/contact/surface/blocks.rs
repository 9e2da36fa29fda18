//! Blocks of a grid, sixteen side by side: a cheap proof that a sheet does not touch itself.
//!
//! A lane of a grid's cells is a patch of neighbours, so boxes around blocks of a patch need no work across lanes:
//!
//! ```text
//!     lane 0   lane 1          each block: a box around its corners and their ways,
//!     +--+--+  +--+--+         a box around its edges along the rows, and one around those down the columns, at both
//!     |  |  |  |  |  |         ends of the way. The normals of all its faces are products of the two.
//!     +--+--+  +--+--+
//! ```
//!
//! Four blocks around a corner that lie flat together do not touch each other, whatever the diagonals of their squares. All
//! others must keep apart, or lie flat together if only one block is between them.
//!
//! Design: `docs/design/self_contact.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::{Vec3, Vec3A};

use crate::broad_phase::swept_box::{SweptBox, SweptBoxes};
use crate::geometry::lane_boxes::{CellBoxes, LaneBoxes};
use crate::geometry::nearest_lanes::{least, most};
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::simd::lanes::{Lanes3, load, of_two, set_lanes};
use crate::state::layout::{Grid, Layout, ROWS_OF_STRIP};
use crate::state::topology::Topology;

/// Squares along a block's side at most.
const MOST_SQUARES: usize = 8;

/// Sizes of blocks that are tried, each half of the one before.
const FINENESSES: usize = 2;

/// Faces lean to one side if their normals, at rest 1 long, are longer than this along the middle one; and where particles have
/// left their ways.
const LEAST_COSINE: f32 = 0.1;
const LEAST_COSINE_LEFT: f32 = 0.02;

/// Blocks one below another, in sixteen lanes.
#[derive(Clone, Copy, Debug)]
struct BlockRow {
    bounds: SweptBoxes,
    all: SweptBox,
    /// Edges along the rows and down the columns, in parts of their lengths at rest.
    across: CellBoxes,
    down: CellBoxes,
    /// Greatest deviations of a block's corners from their ways against each other, in metres.
    off: Cell,
}

impl BlockRow {
    const NOTHING: Self = Self {
        bounds: SweptBoxes::NOTHING,
        all: SweptBox::NOTHING,
        across: CellBoxes::NOTHING,
        down: CellBoxes::NOTHING,
        off: Cell { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] },
    };
}

/// The blocks of a grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blocks {
    rows: Vec<BlockRow>,
    /// True if the whole sheet lies flat; else the rows with blocks that come near each other, but lie flat together.
    lies_flat: bool,
    close: Vec<[u32; 2]>,
    /// Blocks side by side in a patch, and squares along their sides.
    side_by_side: usize,
    side: usize,
    /// Metres that particles may be off their ways.
    slack: f32,
    /// One over the lengths of the squares' sides at rest, in 1/m.
    scales: [f32; 2],
}

impl Blocks {
    /// Metres that particles may be off their ways.
    pub fn slack(&self) -> f32 {
        self.slack
    }
}

/// A grid whose patches lie side by side, on its way.
pub(crate) struct FlyingGrid<'a> {
    grid: Grid,
    /// One over the lengths of its squares' sides at rest, in 1/m.
    scales: [f32; 2],
    starts: &'a [Cell],
    ways: &'a [Cell],
    /// Substeps that are left.
    substeps: f32,
    /// Metres that parts keep to the middle between them, and that particles may be off their ways: with blocks of half the size,
    /// half as much.
    reach: f32,
    slack: f32,
}

impl<'a> FlyingGrid<'a> {
    /// The grid of this topology, if it is one.
    pub fn new(
        topology: &Topology,
        [starts, ways]: [&'a [Cell]; 2],
        substeps: u32,
        [reach, slack]: [f32; 2],
    ) -> Option<Self> {
        let &Layout::Grid(grid) = &topology.layout else { return None };
        if !topology.has_faces_by_square || !topology.layout.has_whole_rows() || grid.rows < 2 {
            return None;
        }
        let side = |other: usize| topology.rest[other].distance(topology.rest[0]);
        let scales = [side(1), side(grid.columns)].map(f32::recip);
        let is_wide = scales.iter().all(|scale| scale.is_finite());
        is_wide.then_some(Self { grid, scales, starts, ways, substeps: substeps as f32, reach, slack })
    }

    /// The place of the particles in this column of all patches and in this row, and their way.
    #[inline(always)]
    fn particle<S: Simd>(&self, simd: S, column: usize, row: usize) -> [Lanes3<S>; 2] {
        let width = self.grid.width;
        let cell = row * width + if column == width { 0 } else { column };
        let place = Lanes3::load(simd, &self.starts[cell]);
        let way = Lanes3::load(simd, &self.ways[cell]).times(f32x16::splat(simd, self.substeps));
        if column == width { [place.shifted::<1>(), way.shifted::<1>()] } else { [place, way] }
    }

    /// The lanes in which a square begins in this column of their patch.
    #[inline(always)]
    fn squares<S: Simd>(&self, simd: S, column: usize) -> mask32x16<S> {
        let Grid { width, columns, .. } = self.grid;
        let mut of_lanes = [0.0; LANES];
        of_lanes.iter_mut().enumerate().for_each(|(lane, of)| *of = (lane * width + column + 1) as f32);
        load(simd, &of_lanes).simd_lt(f32x16::splat(simd, columns as f32))
    }

    /// Places blocks with so many squares along their sides.
    #[inline(always)]
    fn place_all<S: Simd>(&self, simd: S, side: usize, slack: f32, blocks: &mut Blocks) {
        let Grid { width, height, .. } = self.grid;
        let side_by_side = width.div_ceil(side);
        blocks.rows.resize((height - 1).div_ceil(side) * side_by_side, BlockRow::NOTHING);
        for (first, blocks) in (0..height - 1).step_by(side).zip(blocks.rows.chunks_exact_mut(side_by_side)) {
            for (from, block) in (0..width).step_by(side).zip(blocks) {
                let (columns, rows) = (from..(from + side).min(width), first..(first + side).min(height - 1));
                self.place(simd, columns, rows, self.reach + slack, block);
            }
        }
        (blocks.side_by_side, blocks.side, blocks.slack) = (side_by_side, side, slack);
        blocks.scales = self.scales;
    }

    /// The block that begins in the first of these columns of a patch, and in the first of these rows.
    #[inline(always)]
    fn place<S: Simd>(
        &self,
        simd: S,
        columns: Range<usize>,
        rows: Range<usize>,
        growth: f32,
        block: &mut BlockRow,
    ) {
        let [scale_across, scale_down] =
            [f32x16::splat(simd, self.scales[0]), f32x16::splat(simd, self.scales[1])];
        let nothing = LaneBoxes::nothing(simd);
        let (mut places, mut ways, mut across, mut down) = (nothing, nothing, nothing, nothing);
        for column in columns.start..=columns.end {
            let (mut of_places, mut of_ways, mut of_across, mut of_down) =
                (nothing, nothing, nothing, nothing);
            let mut above = self.particle(simd, column, rows.start);
            for row in rows.start..=rows.end {
                let [place, way] = self.particle(simd, column, row);
                of_places = of_places.and(LaneBoxes::of(place));
                of_ways = of_ways.and(LaneBoxes::of(way));
                if column > columns.start {
                    let [left, left_way] = self.particle(simd, column - 1, row);
                    of_across = of_across.and(LaneBoxes::of_edge(place.minus(left), way.minus(left_way)));
                }
                if row > rows.start {
                    of_down = of_down.and(LaneBoxes::of_edge(place.minus(above[0]), way.minus(above[1])));
                }
                above = [place, way];
            }
            let is_there = self.squares(simd, column.saturating_sub(1).max(columns.start));
            places = places.and(of_places.only(simd, is_there));
            ways = ways.and(of_ways.only(simd, is_there));
            across = across.and(of_across.only(simd, is_there));
            down = down.and(of_down.only(simd, is_there));
        }
        let ([low, high], [slow, fast]) = (places.all_lanes(), ways.all_lanes());
        let [low, high] = [Vec3A::from(low) - growth, Vec3A::from(high) + growth];
        block.all = SweptBox { low, high, slow: slow.into(), fast: fast.into() };
        let growth = Lanes3::splat(simd, Vec3::splat(growth));
        put(places.low.minus(growth), &mut block.bounds.low);
        put(places.high.plus(growth), &mut block.bounds.high);
        put(ways.low, &mut block.bounds.slow);
        put(ways.high, &mut block.bounds.fast);
        across.times(scale_across).store(&mut block.across);
        down.times(scale_down).store(&mut block.down);
        block.off = Cell::default();
    }
}

#[inline(always)]
fn put<S: Simd>(v: Lanes3<S>, [x, y, z]: &mut [[f32; LANES]; 3]) {
    (*x, *y, *z) = (v.x.to_array(), v.y.to_array(), v.z.to_array());
}

/// Places the blocks: the box around them all, if no two can touch on their ways.
pub(crate) struct KeepApart<'a> {
    pub grid: FlyingGrid<'a>,
    pub blocks: &'a mut Blocks,
}

impl Kernel for KeepApart<'_> {
    type Output = Option<SweptBox>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self { grid: flying, blocks } = self;
        let width = flying.grid.width;
        let coarse = width.div_ceil(width.div_ceil(MOST_SQUARES));
        for halvings in 0..FINENESSES {
            let slack = flying.slack / (1 << halvings) as f32;
            flying.place_all(simd, coarse.div_ceil(1 << halvings), slack, blocks);
            if blocks.keep_apart(simd, LEAST_COSINE) {
                return Some(blocks.rows.iter().fold(SweptBox::NOTHING, |all, row| all.and(&row.all)));
            }
        }
        None
    }
}

/// True if placed blocks still keep apart, with their corners off their ways: for each strip of the body, boxes around how far.
pub(crate) struct StillKeepApart<'a> {
    pub blocks: &'a mut Blocks,
    pub off: &'a [CellBoxes],
}

impl Kernel for StillKeepApart<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { blocks, off } = self;
        let &mut Blocks { side_by_side, side, .. } = blocks;
        for (first, rows) in blocks.rows.chunks_mut(side_by_side).enumerate() {
            // A block ends with the first row of the one below.
            let strips = first * side / ROWS_OF_STRIP..=(first + 1) * side / ROWS_OF_STRIP;
            let mut all = LaneBoxes::nothing(simd);
            for off in &off[*strips.start()..off.len().min(strips.end() + 1)] {
                all = all.and(LaneBoxes::load(simd, off));
            }
            let off = all.and(all.next_lanes().only(simd, has_next(simd)));
            off.high.minus(off.low).store(&mut rows[0].off);
            let of_row = rows[0].off;
            rows.iter_mut().for_each(|row| row.off = of_row);
        }
        let placed = Placed {
            rows: &blocks.rows,
            scales: blocks.scales,
            side_by_side,
            least_cosine: LEAST_COSINE_LEFT,
        };
        if blocks.lies_flat {
            return placed.lies_flat(simd) || blocks.keep_apart(simd, LEAST_COSINE_LEFT);
        }
        if !placed.neighbours_lie_flat(simd) {
            return false;
        }
        for &[a, b] in &blocks.close {
            if placed.meet(simd, a as usize, b as usize) == Meeting::Touch {
                return false;
            }
        }
        true
    }
}

/// All lanes but the last.
#[inline(always)]
fn has_next<S: Simd>(simd: S) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, u64::from(u16::MAX >> 1))
}

impl Blocks {
    /// True if no two blocks can touch, or faces of one. Notes which are close.
    #[inline(always)]
    fn keep_apart<S: Simd>(&mut self, simd: S, least_cosine: f32) -> bool {
        let Self { rows, close, side_by_side, scales, .. } = self;
        let placed = Placed { rows, scales: *scales, side_by_side: *side_by_side, least_cosine };
        self.lies_flat = placed.lies_flat(simd);
        self.lies_flat || placed.neighbours_lie_flat(simd) && placed.others_keep_apart(simd, close)
    }
}

/// The blocks where they are.
struct Placed<'a> {
    rows: &'a [BlockRow],
    scales: [f32; 2],
    side_by_side: usize,
    least_cosine: f32,
}

/// The meeting of blocks that are not neighbours.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Meeting {
    StayAway,
    /// Some come near each other, but lie flat together.
    LieFlat,
    Touch,
}

impl Placed<'_> {
    #[inline(always)]
    fn edges<S: Simd>(&self, simd: S, row: usize) -> [LaneBoxes<S>; 2] {
        let row = &self.rows[row];
        let off = Lanes3::load(simd, &row.off);
        of_two(
            [(&row.across, self.scales[0]), (&row.down, self.scales[1])],
            #[inline(always)]
            |(edges, scale)| {
                let (edges, off) = (LaneBoxes::load(simd, edges), off.times(f32x16::splat(simd, scale)));
                LaneBoxes { low: edges.low.minus(off), high: edges.high.plus(off) }
            },
        )
    }

    /// The edges of the blocks and of those to the right of them.
    #[inline(always)]
    fn edges_and_next<S: Simd>(&self, simd: S, row: usize) -> [LaneBoxes<S>; 2] {
        let own = self.edges(simd, row);
        let next = if (row + 1).is_multiple_of(self.side_by_side) {
            of_two(
                self.edges(simd, row + 1 - self.side_by_side),
                #[inline(always)]
                |edges| edges.next_lanes().only(simd, has_next(simd)),
            )
        } else {
            self.edges(simd, row + 1)
        };
        both(own, next)
    }

    /// True if the whole sheet lies flat.
    #[inline(always)]
    fn lies_flat<S: Simd>(&self, simd: S) -> bool {
        let mut all = [LaneBoxes::nothing(simd); 2];
        for row in 0..self.rows.len() {
            all = both(all, self.edges(simd, row));
        }
        let all = of_two(
            all,
            #[inline(always)]
            |edges| {
                let [low, high] = edges.all_lanes();
                LaneBoxes { low: Lanes3::splat(simd, low), high: Lanes3::splat(simd, high) }
            },
        );
        are_flat(simd, self.least_cosine, all).all_true()
    }

    /// True if all blocks lie flat with those around each of their corners.
    #[inline(always)]
    fn neighbours_lie_flat<S: Simd>(&self, simd: S) -> bool {
        for row in 0..self.rows.len() {
            let mut edges = self.edges_and_next(simd, row);
            if row + self.side_by_side < self.rows.len() {
                edges = both(edges, self.edges_and_next(simd, row + self.side_by_side));
            }
            let [own, _] = self.edges(simd, row);
            let is_flat = are_flat(simd, self.least_cosine, edges) | own.low.x.simd_gt(own.high.x);
            if !is_flat.all_true() {
                return false;
            }
        }
        true
    }

    /// True if no two blocks that are not neighbours can touch. Lists the rows with `close` ones that must lie flat for that.
    #[inline(always)]
    fn others_keep_apart<S: Simd>(&self, simd: S, close: &mut Vec<[u32; 2]>) -> bool {
        close.clear();
        for a in 0..self.rows.len() {
            let all = &self.rows[a].all;
            for b in (a..self.rows.len()).filter(|&b| all.meets(&self.rows[b].all)) {
                match self.meet(simd, a, b) {
                    Meeting::StayAway => {}
                    Meeting::LieFlat => close.push([a as u32, b as u32]),
                    Meeting::Touch => return false,
                }
            }
        }
        true
    }

    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, a: usize, b: usize) -> Meeting {
        let (own, other) = (&self.rows[a], &self.rows[b]);
        let rows_between = b / self.side_by_side - a / self.side_by_side;
        let mut meeting = Meeting::StayAway;
        for lane in set_lanes(own.bounds.meets(simd, &other.all)) {
            let near = |most: usize| if rows_between <= most { self.near(a, lane, b, most) } else { 0 };
            let mut hits = other.bounds.meets_lane(simd, &own.bounds, lane) & !near(1);
            if a == b {
                hits &= u16::MAX.checked_shl(lane as u32 + 1).unwrap_or(0);
            }
            if hits == 0 {
                continue;
            }
            meeting = Meeting::LieFlat;
            let own = of_two(
                self.edges(simd, a),
                #[inline(always)]
                |edges| edges.splat_lane(simd, lane),
            );
            let flat = are_flat(simd, self.least_cosine, both(own, self.edges(simd, b))).to_bitmask() as u16;
            if hits & !(near(2) & flat) != 0 {
                return Meeting::Touch;
            }
        }
        meeting
    }

    /// Bit mask of the lanes of row `b` whose blocks are at most so many columns of blocks away from that in `lane` of row `a`.
    #[inline(always)]
    fn near(&self, a: usize, lane: usize, b: usize, most: usize) -> u16 {
        let column = |row: usize, lane: usize| lane * self.side_by_side + row % self.side_by_side;
        let own = column(a, lane);
        let lanes = lane.saturating_sub(most)..(lane + most + 1).min(LANES);
        lanes.fold(0, |near, other| near | (u16::from(column(b, other).abs_diff(own) <= most) << other))
    }
}

#[inline(always)]
fn both<S: Simd>([a, b]: [LaneBoxes<S>; 2], [c, d]: [LaneBoxes<S>; 2]) -> [LaneBoxes<S>; 2] {
    [a.and(c), b.and(d)]
}

/// Lanes in which the normals of all faces with such edges along the rows and down the columns lean to one side.
#[inline(always)]
fn are_flat<S: Simd>(simd: S, least_cosine: f32, [across, down]: [LaneBoxes<S>; 2]) -> mask32x16<S> {
    let (a, b, c, d) = (down.low, down.high, across.low, across.high);
    let [x, y, z] = [
        difference(product([a.y, b.y], [c.z, d.z]), product([a.z, b.z], [c.y, d.y])),
        difference(product([a.z, b.z], [c.x, d.x]), product([a.x, b.x], [c.z, d.z])),
        difference(product([a.x, b.x], [c.y, d.y]), product([a.y, b.y], [c.x, d.x])),
    ];
    let zero = f32x16::splat(simd, 0.0);
    let (mut lowest, mut squares) = (zero, zero);
    for [low, high] in [x, y, z] {
        let way = low + high;
        lowest += least(way * low, way * high);
        squares += way * way;
    }
    let cosine = f32x16::splat(simd, least_cosine * least_cosine);
    lowest.simd_gt(zero) & (lowest * lowest).simd_gt(cosine * squares)
}

/// The range of products of two numbers out of these ranges.
#[inline(always)]
fn product<S: Simd>([a, b]: [f32x16<S>; 2], [c, d]: [f32x16<S>; 2]) -> [f32x16<S>; 2] {
    let (p, q, r, s) = (a * c, a * d, b * c, b * d);
    [least(least(p, q), least(r, s)), most(most(p, q), most(r, s))]
}

/// The range of differences of two numbers out of these ranges.
#[inline(always)]
fn difference<S: Simd>([a, b]: [f32x16<S>; 2], [c, d]: [f32x16<S>; 2]) -> [f32x16<S>; 2] {
    [a - d, b - c]
}
