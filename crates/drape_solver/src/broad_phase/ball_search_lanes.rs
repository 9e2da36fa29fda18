//! The search for faces near a ball, cell by cell: its kernels.
//!
//! Design: `docs/design/ball_cloth.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::broad_phase::ball_search::{Squares, set};
use crate::geometry::lane_boxes::LaneBoxes;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::simd::lanes::{Lanes3, set_lanes};

/// Marks the particles that are within reach.
pub(crate) struct Mark<'a> {
    pub cells: &'a [Cell],
    pub centre: Vec3,
    pub reach: f32,
    pub marks: &'a mut Vec<u16>,
}

impl Kernel for Mark<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let centre = Lanes3::splat(simd, self.centre);
        let reach = f32x16::splat(simd, self.reach * self.reach);
        for cell in self.cells {
            let offset = Lanes3::load(simd, cell).minus(centre);
            self.marks.push(offset.dot(offset).simd_lt(reach).to_bitmask() as u16);
        }
    }
}

/// The boxes of a row of cells, with the first cell of the next lane, which a lane's last square reaches.
#[inline(always)]
fn row_boxes<S: Simd>(simd: S, cells: &[Cell]) -> LaneBoxes<S> {
    let first = LaneBoxes::of(Lanes3::load(simd, &cells[0]));
    let mut all = first.and(first.next_lanes());
    for cell in &cells[1..] {
        all = all.and(LaneBoxes::of(Lanes3::load(simd, cell)));
    }
    all
}

/// The longest way of a particle in this substep so far, in metres.
pub(crate) struct LongestTravel<'a> {
    pub position: &'a [Cell],
    pub displacement: &'a [Cell],
    pub integrated: &'a [Cell],
}

impl Kernel for LongestTravel<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> f32 {
        let Self { position, displacement, integrated } = self;
        let mut longest = f32x16::splat(simd, 0.0);
        for ((position, displacement), integrated) in position.iter().zip(displacement).zip(integrated) {
            let projected = Lanes3::load(simd, position).minus(Lanes3::load(simd, integrated));
            let travel = projected.plus(Lanes3::load(simd, displacement));
            longest = longest.max(travel.dot(travel));
        }
        longest.to_array().into_iter().fold(0.0, f32::max).sqrt()
    }
}

/// Finds squares near a ball.
pub(crate) struct SquareTest<'a> {
    pub cells: &'a [Cell],
    pub squares: Squares,
    pub centre: Vec3,
    /// Distance in metres at which a face is near.
    pub touch: f32,
    /// For each cell of squares, the lanes that are near.
    pub masks: &'a mut Vec<u16>,
}

impl Kernel for SquareTest<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { cells, squares, centre, touch, masks } = self;
        let width = squares.grid.width;
        let centre = Lanes3::splat(simd, centre);
        let touch = f32x16::splat(simd, touch * touch);
        masks.clear();
        masks.resize(squares.count * width, 0);
        let mut cells = &cells[squares.first * width..];
        let mut above = row_boxes(simd, &cells[..width]);
        for masks in masks.chunks_exact_mut(width) {
            let (upper, lower) = cells.split_at(width);
            let lower = &lower[..width];
            cells = &cells[width..];
            let below = row_boxes(simd, lower);
            let is_near = above.and(below).distance_squared(simd, centre).simd_le(touch).any_true();
            above = below;
            if !is_near {
                continue;
            }
            let first = LaneBoxes::of(Lanes3::load(simd, &upper[0]))
                .and(LaneBoxes::of(Lanes3::load(simd, &lower[0])));
            let mut left = first;
            for (cell, mask) in masks.iter_mut().enumerate() {
                let right = if cell + 1 < width {
                    let upper = LaneBoxes::of(Lanes3::load(simd, &upper[cell + 1]));
                    upper.and(LaneBoxes::of(Lanes3::load(simd, &lower[cell + 1])))
                } else {
                    first.next_lanes()
                };
                let around = left.and(right);
                *mask = around.distance_squared(simd, centre).simd_le(touch).to_bitmask() as u16;
                left = right;
            }
        }
    }
}

/// Picks the candidates that the ball touches.
pub(crate) struct Sift<'a> {
    pub cells: &'a [Cell],
    /// Slots of the corners of all candidates.
    pub corners: &'a [[u32; 3]],
    pub centre: Vec3,
    /// Distance in metres at which a face is touched.
    pub touch: f32,
    pub around: &'a [u32],
    /// One bit for each candidate, set if the ball touches it.
    pub bits: &'a mut [u64],
}

impl Kernel for Sift<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { cells, corners, centre, touch, around, bits } = self;
        let centre = Lanes3::splat(simd, centre);
        let touch = f32x16::splat(simd, touch * touch);
        let mut gathered = [Cell::default(); 3];
        for some in around.chunks(LANES) {
            for (lane, &candidate) in some.iter().enumerate() {
                for (gathered, slot) in gathered.iter_mut().zip(corners[candidate as usize]) {
                    let (cell, from) = (&cells[slot as usize / LANES], slot as usize % LANES);
                    gathered.x[lane] = cell.x[from];
                    gathered.y[lane] = cell.y[from];
                    gathered.z[lane] = cell.z[from];
                }
            }
            let [a, b, c] = &gathered;
            let a = Lanes3::load(simd, a).minus(centre);
            let b = Lanes3::load(simd, b).minus(centre);
            let c = Lanes3::load(simd, c).minus(centre);
            let mut far = is_beyond(simd, [a, b, c], touch).to_bitmask();
            far |= u64::MAX << some.len();
            set_lanes(!far).for_each(|lane| set(bits, some[lane]));
        }
    }
}

/// True for triangles that are certainly farther from the origin than a distance whose square is `touch`. The nearest
/// point lies on an edge, or in the plane if the origin is over the triangle.
#[inline(always)]
fn is_beyond<S: Simd>(simd: S, [a, b, c]: [Lanes3<S>; 3], touch: f32x16<S>) -> mask32x16<S> {
    let (ab, bc, ca) = (b.minus(a), c.minus(b), a.minus(c));
    let normal = ab.cross(bc);
    let size = normal.dot(normal);
    let zero = f32x16::splat(simd, 0.0);
    let is_over = ab.cross(a).dot(normal).simd_le(zero)
        & bc.cross(b).dot(normal).simd_le(zero)
        & ca.cross(c).dot(normal).simd_le(zero);
    let height = normal.dot(a);
    let over_plane = (height * height).simd_gt(touch * size);
    let edges = edge_distance_squared(simd, a, ab)
        .min(edge_distance_squared(simd, b, bc))
        .min(edge_distance_squared(simd, c, ca));
    // The normal of a sliver is mostly rounding error.
    let has_normal = size.simd_gt(ab.dot(ab) * bc.dot(bc) * 1e-4);
    has_normal & ((is_over & over_plane) | (!is_over & edges.simd_gt(touch)))
}

/// Squared distance of the origin from edges that lead from `from` along `along`.
#[inline(always)]
fn edge_distance_squared<S: Simd>(simd: S, from: Lanes3<S>, along: Lanes3<S>) -> f32x16<S> {
    let one = f32x16::splat(simd, 1.0);
    let zero = f32x16::splat(simd, 0.0);
    let fraction = (-from.dot(along) / along.dot(along)).min(one).max(zero);
    let nearest = from.plus(along.times(fraction));
    nearest.dot(nearest)
}
