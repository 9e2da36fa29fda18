//! The search for corners and faces, and for edges, that may touch: sixteen pairs of stars at a time.
//!
//! With the unit vector `n` between the nearest points of two parts at the start, a pair may be left out if, at the end,
//! the least height of the one part along `n` is above the greatest of the other by more than the reach: heights change
//! evenly on the way, so a plane keeps the two apart all along.
//!
//! ```text
//!     start  o            end      o            height of the lowest corner of the one
//!            | n                 ...............
//!         ---+---              --+--            height of the highest corner of the other
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::contact::surface::pair::{Kind, Pair};
use crate::contact::surface::reach::{Reach, distance_of_edges};
use crate::contact::surface::rows::{
    CENTRE, CENTRES, COLUMNS, Columns, EDGE, EDGE_SCALE, EDGES_TOO, FACE, FACE_SCALE, FACES_ONLY, Row,
    SHARPNESS, THICKNESS, gather, vector,
};
use crate::geometry::nearest_lanes::{TriangleLanes, between_segments, least, most};
use crate::simd::columns::LANES;
use crate::simd::isa::Kernel;
use crate::simd::lanes::{Lanes3, first_lanes, load, set_lanes};
use crate::state::star::{EDGES, FACES, Star};

/// Lists the parts of one kind that may touch, of pairs of stars.
pub(crate) struct Search<'a> {
    pub kind: Kind,
    pub rows: &'a [Row],
    pub stars: &'a [Star],
    pub pairs: &'a [[u32; 2]],
    pub reach: Reach,
    pub found: &'a mut Vec<Pair>,
}

impl Kernel for Search<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { kind, rows, stars, pairs, reach, found } = self;
        let mut columns: [Columns; 2] = [[[0.0; LANES]; COLUMNS]; 2];
        for pairs in pairs.chunks(LANES) {
            let batch = Batch { stars, pairs };
            match kind {
                Kind::CornerFace => {
                    gather(simd, rows, pairs, 0, CENTRES, &mut columns[0]);
                    gather(simd, rows, pairs, 1, CENTRES, &mut columns[1]);
                    gather(simd, rows, pairs, 1, FACES_ONLY, &mut columns[1]);
                    corners(simd, &columns, reach, &batch, found);
                }
                Kind::EdgeEdge => {
                    for (side, columns) in columns.iter_mut().enumerate() {
                        gather(simd, rows, pairs, side, EDGES_TOO, columns);
                    }
                    edges(simd, &columns, reach, &batch, found);
                }
            }
        }
    }
}

/// The stars in the lanes.
struct Batch<'a> {
    stars: &'a [Star],
    pairs: &'a [[u32; 2]],
}

impl Batch<'_> {
    /// Appends the pairs in these lanes whose parts do not share a corner.
    #[inline(always)]
    fn push(&self, lanes: u16, found: &mut Vec<Pair>, pair: impl Fn(usize, [&Star; 2]) -> Pair) {
        for lane in set_lanes(lanes & first_lanes(self.pairs.len())) {
            let stars = self.pairs[lane];
            let pair = pair(lane, stars.map(|star| &self.stars[star as usize]));
            if !pair.is_joined() {
                found.push(Pair { stars, ..pair });
            }
        }
    }
}

/// True where a plane does not keep two parts apart by the `bound`: at the start, with nearest points at `way`, or at the
/// end, with a `gap` in heights that are `way` long.
#[inline(always)]
fn may_meet<S: Simd>(simd: S, way: Lanes3<S>, gap: f32x16<S>, bound: f32x16<S>) -> mask32x16<S> {
    let squared = bound * bound * way.dot(way);
    way.dot(way).simd_lt(bound * bound) | gap.simd_le(f32x16::splat(simd, 0.0)) | (gap * gap).simd_lt(squared)
}

/// The edges of one star and those of another.
#[inline(always)]
fn edges<S: Simd>(simd: S, [a, b]: &[Columns; 2], reach: Reach, batch: &Batch, found: &mut Vec<Pair>) {
    let zero = f32x16::splat(simd, 0.0);
    let distance = load(simd, &a[THICKNESS]) + load(simd, &b[THICKNESS]);
    let w = vector(simd, a, CENTRE[0]).minus(vector(simd, b, CENTRE[0]));
    let later_w = vector(simd, a, CENTRE[1]).minus(vector(simd, b, CENTRE[1]));
    for i in 0..EDGES {
        let sharp = load(simd, &a[SHARPNESS + i]);
        let (u, later_u) = (vector(simd, a, EDGE[0] + 3 * i), vector(simd, a, EDGE[1] + 3 * i));
        let scale = load(simd, &a[EDGE_SCALE + i]);
        for j in 0..EDGES {
            let sharpness = least(sharp, load(simd, &b[SHARPNESS + j]));
            let (v, later_v) = (vector(simd, b, EDGE[0] + 3 * j), vector(simd, b, EDGE[1] + 3 * j));
            let [s, t] = between_segments(simd, w, [u, v], [scale, load(simd, &b[EDGE_SCALE + j])]);
            let n = w.plus(u.times(s)).minus(v.times(t));
            let low = n.dot(later_w) + least(zero, n.dot(later_u));
            let high = most(zero, n.dot(later_v));
            let hits = may_meet(simd, n, low - high, reach.of_edge(simd, distance, sharpness));
            let hits = (hits & sharpness.simd_ge(zero)).to_bitmask() as u16;
            if hits != 0 {
                let kept = distance_of_edges(distance, sharpness).to_array();
                batch.push(hits, found, |lane, [p, q]| Pair {
                    ids: [p.centre, p.ends[i], q.centre, q.ends[j]],
                    kind: Kind::EdgeEdge,
                    distance: kept[lane],
                    ..Pair::default()
                });
            }
        }
    }
}

/// The centre of one star and the faces of another.
#[inline(always)]
fn corners<S: Simd>(simd: S, [a, b]: &[Columns; 2], reach: Reach, batch: &Batch, found: &mut Vec<Pair>) {
    let zero = f32x16::splat(simd, 0.0);
    let distance = load(simd, &a[THICKNESS]) + load(simd, &b[THICKNESS]);
    let bound = reach.of_corner(simd, distance);
    let w = vector(simd, a, CENTRE[0]).minus(vector(simd, b, CENTRE[0]));
    let later_w = vector(simd, a, CENTRE[1]).minus(vector(simd, b, CENTRE[1]));
    for k in 0..FACES {
        let at = |time: usize, side: usize| FACE[time] + 6 * k + 3 * side;
        let scale = &b[FACE_SCALE + 4 * k..];
        let face = TriangleLanes {
            sides: [vector(simd, b, at(0, 0)), vector(simd, b, at(0, 1))],
            inverses: [
                load(simd, &scale[0]),
                load(simd, &scale[1]),
                load(simd, &scale[2]),
                load(simd, &scale[3]),
            ],
        };
        let [s, t] = face.nearest(simd, w);
        let n = w.minus(face.sides[0].times(s)).minus(face.sides[1].times(t));
        let (later_u, later_v) = (vector(simd, b, at(1, 0)), vector(simd, b, at(1, 1)));
        let high = most(zero, most(n.dot(later_u), n.dot(later_v)));
        let hits = may_meet(simd, n, n.dot(later_w) - high, bound);
        let hits = (hits & face.inverses[3].simd_gt(zero)).to_bitmask() as u16;
        if hits != 0 {
            let kept = distance.to_array();
            batch.push(hits, found, |lane, [p, q]| {
                let [_, c, d] = q.face(k);
                Pair { ids: [p.centre, q.centre, c, d], distance: kept[lane], ..Pair::default() }
            });
        }
    }
}
