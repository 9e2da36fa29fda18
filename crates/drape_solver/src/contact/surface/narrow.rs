//! The narrow phase: which of the listed pairs touch in this substep, sixteen at a time.
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::{Vec3, Vec4};

use crate::contact::surface::contact::{Contact, contact};
use crate::contact::surface::pair::{Kind, Pair};
use crate::contact::surface::placed::PlacedSurfaces;
use crate::contact::surface::points::Points;
use crate::contact::surface::rows::{four_places, vector};
use crate::geometry::nearest_lanes::{TriangleLanes, between_segments, inverse, least, most};
use crate::parallel::gather::Gathered;
use crate::simd::columns::LANES;
use crate::simd::isa::Kernel;
use crate::simd::lanes::{Lanes3, first_lanes, set_lanes};
use crate::simd::transpose::transpose;

/// Turns pairs, all of one kind, into contacts.
pub(crate) struct Narrow<'a> {
    pub kind: Kind,
    pub pairs: &'a mut [Pair],
    /// The surfaces at rest, from which pairs of one body get their distances.
    pub surfaces: &'a PlacedSurfaces,
    pub points: &'a Points,
    /// Part of the distance to keep by which contacts may be wider; none if contacts are not looked for.
    pub margin: Option<f32>,
    /// Pairs may pass each other if their plane is left a gap narrower than this, in metres.
    pub risky_gap: f32,
    pub found: &'a mut Found,
}

/// What is found in a substep: pairs that touch, and pairs that may pass each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    pub contacts: Vec<Contact>,
    pub passing: Vec<Contact>,
}

impl Found {
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.passing.clear();
    }
}

impl Gathered for Found {
    fn append(&mut self, later: &mut Self) {
        self.contacts.append(&mut later.contacts);
        self.passing.append(&mut later.passing);
    }
}

impl Kernel for Narrow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { kind, pairs, surfaces, points, margin, risky_gap, found } = self;
        let Points { start, end, flight, .. } = points;
        let factor = margin.map_or(0.0, |margin| 1.0 + margin);
        for pairs in pairs.chunks_mut(LANES) {
            let lanes = Gap::of(simd, kind, [corners(simd, pairs, start), corners(simd, pairs, end)]);
            let mut distances = [0.0; LANES];
            distances.iter_mut().zip(&*pairs).for_each(|(distance, pair)| *distance = pair.distance);
            let distance = f32x16::load_array_ref(simd, &distances);
            let near = lanes.height.simd_lt(distance * factor).to_bitmask() as u16;
            let near = if margin.is_some() { near } else { 0 };
            let risky = lanes.gap.simd_lt(f32x16::splat(simd, risky_gap)).to_bitmask() as u16;
            let hits = (near | risky) & first_lanes(pairs.len());
            if hits == 0 {
                continue;
            }
            let [s, t] = [lanes.weights[0].to_array(), lanes.weights[1].to_array()];
            let way = [lanes.way.x.to_array(), lanes.way.y.to_array(), lanes.way.z.to_array()];
            let height = lanes.height.to_array();
            for lane in set_lanes(hits) {
                let pair = &mut pairs[lane];
                if !pair.knows_rest {
                    surfaces.note_rest(pair);
                }
                let weights = kind.weights([s[lane], t[lane]]);
                let way = Vec3::new(way[0][lane], way[1][lane], way[2][lane]);
                let Some(contact) = contact(*pair, weights, way) else { continue };
                if risky & (1 << lane) != 0 {
                    found.passing.push(contact);
                }
                if margin.is_some() && height[lane] < pair.distance * factor && contact.is_in_reach(flight) {
                    found.contacts.push(contact);
                }
            }
        }
    }
}

/// The corners of up to sixteen pairs: each pair is a row of four places, and a transposed block has their columns.
#[inline(always)]
fn corners<S: Simd>(simd: S, pairs: &[Pair], places: &[Vec4]) -> [Lanes3<S>; 4] {
    let mut ids = [pairs[0].ids; LANES];
    ids.iter_mut().zip(pairs).for_each(|(ids, pair)| *ids = pair.ids);
    let mut columns = [[0.0; LANES]; LANES];
    transpose(
        #[inline(always)]
        |row| four_places(simd, places, ids[row]),
        #[inline(always)]
        |column, vector| columns[column] = vector.to_array(),
    );
    [
        vector(simd, &columns, 0),
        vector(simd, &columns, 4),
        vector(simd, &columns, 8),
        vector(simd, &columns, 12),
    ]
}

/// Nearest points at the start, and what is left between the two at the end.
struct Gap<S: Simd> {
    weights: [f32x16<S>; 2],
    /// From the second part to the first, at the start.
    way: Lanes3<S>,
    /// Height of the first point above the second at the end, along the way, in metres.
    height: f32x16<S>,
    /// Height of the lowest corner of the first part above the highest one of the second.
    gap: f32x16<S>,
}

impl<S: Simd> Gap<S> {
    #[inline(always)]
    fn of(simd: S, kind: Kind, [start, end]: [[Lanes3<S>; 4]; 2]) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        match kind {
            Kind::CornerFace => {
                let (w, later_w) = (start[0].minus(start[1]), end[0].minus(end[1]));
                let [u, v] = [start[2].minus(start[1]), start[3].minus(start[1])];
                let [s, t] = TriangleLanes::new(simd, [u, v]).nearest(simd, w);
                let way = w.minus(u.times(s)).minus(v.times(t));
                let n = way.times(inverse(simd, way.dot(way)).sqrt());
                let (a, b) = (n.dot(end[2].minus(end[1])), n.dot(end[3].minus(end[1])));
                let top = n.dot(later_w);
                let gap = top - most(zero, most(a, b));
                Self { weights: [s, t], way, height: top - s * a - t * b, gap }
            }
            Kind::EdgeEdge => {
                let (w, later_w) = (start[0].minus(start[2]), end[0].minus(end[2]));
                let [u, v] = [start[1].minus(start[0]), start[3].minus(start[2])];
                let inverses = [inverse(simd, u.dot(u)), inverse(simd, v.dot(v))];
                let [s, t] = between_segments(simd, w, [u, v], inverses);
                let way = w.plus(u.times(s)).minus(v.times(t));
                let n = way.times(inverse(simd, way.dot(way)).sqrt());
                let (a, b) = (n.dot(end[1].minus(end[0])), n.dot(end[3].minus(end[2])));
                let foot = n.dot(later_w);
                let gap = foot + least(zero, a) - most(zero, b);
                Self { weights: [s, t], way, height: foot + s * a - t * b, gap }
            }
        }
    }
}
