//! Frayed edges: torn cloth is drawn with rough edges, not along the steps of its faces.
//!
//! ```text
//!   o---o                  A particle p at a tear is drawn halfway towards the middle m of those before and
//!       |      o .         behind it, which turns steps into a slope, and a little aside. Between two there is
//!       p---o    m p .     one more vertex, beside the middle. If the body is flat at rest, both sides draw
//!           |        . o   the same line: nothing is lost, and no gap shows before the tear opens.
//!           o
//! ```
//!
//! The simulation stays as it is. Only particles inside the whole body move, so its hem keeps its shape.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;

use crate::splitmix::SplitMix64;
use crate::state::topology::Topology;
use crate::tearing::blade::weights_at;

/// A point of the plane of a face: inside it, or beside it at less than its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePoint {
    /// Index of the face.
    pub face: u32,
    /// The weights of its three particles, which sum to 1.
    pub weights: Vec3,
}

/// The past of a torn body, or of a piece of it.
#[derive(Clone, Copy, Debug)]
pub struct TornPast<'a> {
    /// The body before its first tear.
    pub whole: &'a Topology,
    /// For each particle the index in the whole; for a copy, that of the particle it was split from.
    pub origins: &'a [u32],
    /// The edges of faces along which the whole has torn ([`Torn::edges`](crate::Torn::edges) of all tears), by its particles, the lower
    /// index first, tear by tear.
    pub edges: &'a [[u32; 2]],
    /// Bodies with other seeds fray in other ways.
    pub seed: u64,
}

/// The places of a torn body that are drawn elsewhere than its faces say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrayedEdges {
    /// The places of particles.
    pub particles: BTreeMap<u32, FacePoint>,
    /// Places between the ends of torn edges, by their particles, the lower index first.
    pub edges: BTreeMap<[u32; 2], FacePoint>,
}

impl FrayedEdges {
    /// The frayed edges of a torn body, or of a piece of it. Particles for which `may_move` is false stay in place.
    ///
    /// # Panics
    /// If `past` is not that of this body: if it has another number of particles, or names some that the whole does not have.
    pub fn new(body: &Topology, past: &TornPast, may_move: impl Fn(u32) -> bool) -> Self {
        let mut frayed = Self::default();
        if past.edges.is_empty() {
            return frayed;
        }
        let tear = TearLine::new(past);
        let origin = |particle: u32| past.origins[particle as usize];
        let mut is_divided = vec![false; body.faces.len()];
        body.parts.iter().for_each(|part| is_divided[part.face as usize] = true);
        let mut fans: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut sides: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (face, &corners) in (0..).zip(&body.faces) {
            if !corners.iter().any(|&corner| tear.is_end[origin(corner) as usize]) {
                continue;
            }
            corners.iter().for_each(|&corner| fans.entry(corner).or_default().push(face));
            let [a, b, c] = corners;
            for [p, q] in [[a, b], [b, c], [c, a]] {
                sides.entry([p.min(q), p.max(q)]).or_default().push(face);
            }
        }
        // A place in the plane of a face; none if the face has no area.
        let point = |face: u32, place: Vec3| {
            let corners = body.faces[face as usize].map(|corner| tear.rest(origin(corner)).as_dvec3());
            Some(FacePoint { face, weights: weights_at(&corners, place.as_dvec3()).as_vec3() })
                .filter(|point| point.weights.is_finite())
        };
        let mut moved = BTreeSet::new();
        for (&[p, q], faces) in &sides {
            if let [face] = faces[..]
                && let Some(place) = tear.between(origin(p), origin(q))
            {
                moved.extend([p, q]);
                let between = point(face, place).filter(|_| !is_divided[face as usize]);
                frayed.edges.extend(between.map(|point| ([p, q], point)));
            }
        }
        for particle in moved {
            let Some(place) = tear.place(origin(particle)) else { continue };
            let fan = &fans[&particle];
            if may_move(particle) && fan.iter().all(|&face| !is_divided[face as usize]) {
                let inside = |point: &FacePoint| point.weights.min_element();
                let points = fan.iter().filter_map(|&face| point(face, place));
                let nearest = points.max_by(|p, q| inside(p).total_cmp(&inside(q)));
                frayed.particles.extend(nearest.map(|point| (particle, point)));
            }
        }
        frayed
    }
}

/// The edges along which a body has torn, before the tear and at rest. Particles and faces are those of the whole body.
struct TearLine<'a> {
    whole: &'a Topology,
    edges: BTreeSet<[u32; 2]>,
    /// True for each end of an edge.
    is_end: Vec<bool>,
    /// The faces around each end of an edge.
    fans: BTreeMap<u32, Vec<u32>>,
    /// The other ends of the edges at each end of one, tear by tear.
    neighbours: BTreeMap<u32, Vec<u32>>,
    seed: u64,
}

impl<'a> TearLine<'a> {
    fn new(&TornPast { whole, edges, seed, .. }: &TornPast<'a>) -> Self {
        let mut neighbours: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &[a, b] in edges {
            neighbours.entry(a).or_default().push(b);
            neighbours.entry(b).or_default().push(a);
        }
        let mut is_end = vec![false; whole.particle_count()];
        neighbours.keys().for_each(|&end| is_end[end as usize] = true);
        let mut fans: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (face, corners) in (0..).zip(&whole.faces) {
            for &corner in corners.iter().filter(|&&corner| is_end[corner as usize]) {
                fans.entry(corner).or_default().push(face);
            }
        }
        Self { whole, edges: edges.iter().copied().collect(), is_end, fans, neighbours, seed }
    }

    fn rest(&self, particle: u32) -> Vec3 {
        self.whole.rest_position(particle as usize)
    }

    fn corners(&self, face: u32) -> [Vec3; 3] {
        self.whole.faces[face as usize].map(|corner| self.rest(corner))
    }

    /// The place at rest at which a particle is drawn; none if it stays: if no tear goes through it, or at the hem of the whole body.
    fn place(&self, particle: u32) -> Option<Vec3> {
        let (fan, neighbours) = (self.fans.get(&particle)?, &*self.neighbours[&particle]);
        let faces = || fan.iter().map(|&face| self.whole.faces[face as usize]);
        let is_inside =
            faces().flatten().all(|corner| faces().filter(|face| face.contains(&corner)).count() > 1);
        // Later tears at the same particle change nothing, as pieces that have come off do not know of them.
        let [before, behind] = *neighbours.first_chunk::<2>().filter(|_| is_inside)?;
        let at = self.rest(particle);
        let slope = (self.rest(before).midpoint(self.rest(behind)) - at) * 0.5;
        let [along, across] = self.plane(fan)?;
        let [x, y] = [0, 1].map(|axis| self.random([particle, particle], axis));
        let aside = (along * x + across * y).clamp_length_max(1.0);
        let least = fan.iter().map(|&face| width(self.corners(face))).fold(f32::INFINITY, f32::min);
        Some(at + (slope + aside * (ROUGHNESS * least)).clamp_length_max(MOST * least))
    }

    /// The place at rest of the vertex between the ends of a torn edge; none if it is not one.
    fn between(&self, p: u32, q: u32) -> Option<Vec3> {
        let (a, b) = (p.min(q), p.max(q));
        if !self.edges.contains(&[a, b]) {
            return None;
        }
        let [from, to] = [a, b].map(|end| self.place(end).unwrap_or_else(|| self.rest(end)));
        let fan = self.fans.get(&a)?;
        let [along, across] = self.plane(fan)?;
        let normal = along.cross(across);
        let middle = from.midpoint(to);
        // The distance from the middle to the lines from the ends to the centres of the faces beside the edge, wherever those are drawn: no
        // vertices of two edges of a face meet.
        let beside = fan.iter().map(|&face| self.whole.faces[face as usize]).filter(|face| face.contains(&b));
        let room = beside.fold(f32::INFINITY, |room, corners| {
            let Some(third) = corners.into_iter().find(|corner| ![a, b].contains(corner)) else {
                return room;
            };
            let centre = (from + to + self.rest(third)) / 3.0;
            let moved = MOST * width(corners.map(|corner| self.rest(corner))) / 3.0;
            let to_side = |end: Vec3| {
                let (side, half) = (centre - end, middle - end);
                (side.cross(half).length() - moved * half.length()) / (side.length() + moved)
            };
            room.min(to_side(from)).min(to_side(to))
        });
        if !room.is_finite() {
            return None;
        }
        let aside = normal.cross(to - from).normalize_or_zero() * (self.random([a, b], 0) * room.max(0.0));
        Some(middle + aside * BESIDE_EDGE)
    }

    /// Two unit vectors at right angles in the plane of some faces at rest; none if they have no area.
    fn plane(&self, fan: &[u32]) -> Option<[Vec3; 2]> {
        let area = |&face: &u32| {
            let [a, b, c] = self.corners(face);
            (b - a).cross(c - a)
        };
        let normal = fan.iter().map(area).sum::<Vec3>().try_normalize()?;
        let along = normal.any_orthonormal_vector();
        Some([along, normal.cross(along)])
    }

    /// A number from -1 to 1 that is always the same for an edge of the body, or a particle.
    fn random(&self, [a, b]: [u32; 2], place: u64) -> f32 {
        let of_edge = SplitMix64(u64::from(a) << 32 | u64::from(b)).bits();
        let of_body = SplitMix64(of_edge ^ self.seed).bits();
        SplitMix64(of_body ^ place).signed()
    }
}

/// The least height of a triangle in metres.
fn width([a, b, c]: [Vec3; 3]) -> f32 {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    if longest > 0.0 { (b - a).cross(c - a).length() / longest } else { 0.0 }
}

/// The most by which a particle is drawn beside its place, in widths of the narrowest face around it: below one half no face turns over.
const MOST: f32 = 0.45;

/// The most that chance adds to that, in the same widths.
const ROUGHNESS: f32 = 0.4;

/// Part of the room beside the middle of an edge in which a vertex is drawn.
const BESIDE_EDGE: f32 = 0.9;
