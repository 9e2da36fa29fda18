//! Cloth and ropes against themselves and each other, by corners, faces and edges.
//!
//! Two triangles that touch do so with a corner of one on the face of the other, or edge on edge. Either way the two
//! nearest points are weighted means of corners, `sum a_i x_i` and `sum b_i x_i`, and one formula serves both:
//!
//! ```text
//!   corner on face          edge on edge           C = n . (sum a_i x_i - sum b_i x_i) - (t_a + t_b)
//!        o                    o                    if C < 0:  l = -C / sum w_i (a_i or b_i)^2
//!        | n               o--|--o                            x_i += w_i l a_i n   or   x_i -= w_i l b_i n
//!     /--+--\                 o
//! ```
//!
//! What has passed through within the substep is led back to the side that it came from: then the normal is that of the
//! place and time of passing. Layers that cross when a substep begins have no such side. There contacts would hold the
//! tangle fast, so those whose corners all lie at a crossing are let be, and the crossing is led apart instead, in
//! position only (`crossing`).

use glam::Vec3;

use crate::broad_phase::relative_motion::{Motion, RelativeMotion};
use crate::broad_phase::surface_pairs::{PlacedSurface, PlacedTree};
use crate::constants::{
    CONTACT_SLACK, NEIGHBOURS_AT_REST, SKIN, SKIN_OF_EDGE, SLACK_OF_SUBSTEPS, UNTANGLING_SPEED,
};
use crate::contact::ccd::{Passage, edges_passed, face_passed};
use crate::contact::cloth_cloth::{ClothContact, Corner, Penetration, has_triangles};
use crate::contact::depenetration::PushOutRate;
use crate::contact::untangle::{CrossedFaces, crossings};
use crate::geometry::nearest_segments::between_segments;
use crate::geometry::nearest_triangle::on_triangle;
use crate::geometry::separation::separation;
use crate::state::body::Body;
use crate::state::surface_tree::SurfaceElement;

/// The triangles of an island that may touch each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct TrianglePairs {
    /// Of each body, where the patches and the particles are, the latter by slot.
    trees: Vec<PlacedTree>,
    places: Vec<Vec<CornerPlaces>>,
    pairs: Vec<Pair>,
    /// For each pair the relative motion from which on it has to be looked at again.
    wake_at: Vec<f32>,
    /// Relative motion up to which the list holds; none if there is no list.
    holds_until: Option<f32>,
    /// Relative motion up to which those found near are all that may touch.
    found_until: f32,
    /// Pairs that are near enough to be looked at.
    awake: Vec<Awake>,
    /// Edges through faces, when the substep began.
    crossings: Vec<CrossedFaces>,
    /// For each body its slots at a crossing, and a list of those.
    is_crossing: Vec<Vec<bool>>,
    crossing_slots: Vec<Corner>,
    /// What may touch in this substep.
    near: Vec<ClothContact<4>>,
    kinds: Vec<Kind>,
    /// How often the projections may still be repeated in this step.
    repeats_left: u32,
}

/// Where a particle was when the substep began, and is after its flight.
#[derive(Clone, Copy, Debug)]
struct CornerPlaces {
    start: Vec3,
    now: Vec3,
}

/// Two elements and what of them is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pair {
    bodies: [u32; 2],
    elements: [u32; 2],
    /// Bits of corners of the first on the second's face (0 to 2) and the other way round (3 to 5), of edge `j` on edge
    /// `k` (6 + 3 j + k), and of whether they may cross (15).
    parts: u16,
}

const MAY_CROSS: u16 = 1 << 15;

#[derive(Clone, Copy, Debug)]
struct Awake {
    pair: Pair,
    /// How far the two could come nearer in the flight of this substep, in metres.
    flight: f32,
}

/// What touches: the first corner the face of the others, or the first two the last two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    CornerFace,
    EdgeEdge,
}

impl TrianglePairs {
    /// Forgets all pairs.
    pub fn clear(&mut self) {
        self.holds_until = None;
        self.pairs.clear();
        self.wake_at.clear();
        self.near.clear();
        self.kinds.clear();
    }

    /// Forgets the contacts of a body.
    pub fn forget(&mut self, body: usize) {
        let gone =
            |contact: &ClothContact<4>| contact.corners.iter().any(|corner| corner.body as usize == body);
        if self.near.iter().any(gone) {
            self.near.clear();
            self.kinds.clear();
        }
    }

    /// Whether anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        !self.near.is_empty()
    }

    /// Those that may touch in this substep.
    pub fn near(&self) -> &[ClothContact<4>] {
        &self.near
    }

    /// The number of pairs that are watched.
    pub fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// Finds what may touch in this substep, and leads crossings apart.
    pub fn begin_substep(&mut self, bodies: &mut [Body], motion: &RelativeMotion, rate: PushOutRate) {
        if !bodies.iter().any(has_triangles) {
            self.clear();
            return;
        }
        // Anew in each step, so that no step knows of another.
        let now = motion.of_step.now;
        if rate.is_first() {
            self.repeats_left = MOST_REPEATS;
        }
        if rate.is_first() || self.holds_until.is_none() || now > self.found_until {
            self.note_places(bodies);
            if rate.is_first() || self.holds_until.is_none_or(|end| now > end) {
                self.list(bodies, now);
            }
            self.wake(bodies, &motion.of_step);
            self.find_near(bodies, &motion.of_step);
        } else {
            self.near.iter_mut().for_each(ClothContact::begin_substep);
        }
        let way = UNTANGLING_SPEED * rate.substep();
        self.crossings.iter().for_each(|crossing| crossing.lead_apart(bodies, way));
    }

    fn note_places(&mut self, bodies: &[Body]) {
        let origin = bodies[0].particles.origin;
        self.places.resize_with(bodies.len(), Vec::new);
        for (places, body) in self.places.iter_mut().zip(bodies) {
            places.clear();
            if has_triangles(body) {
                let shift = body.particles.origin - origin;
                let slots = 0..body.particles.inverse_mass.len();
                places.extend(slots.map(|slot| {
                    let now = body.particles.position.get(slot) + shift;
                    CornerPlaces { start: now - body.particles.displacement.get(slot), now }
                }));
            }
        }
    }

    /// Lists the pairs that may touch before something has moved through the skin.
    fn list(&mut self, bodies: &[Body], motion: f32) {
        let Self { trees, places, pairs, wake_at, holds_until, is_crossing, crossing_slots, .. } = self;
        pairs.clear();
        wake_at.clear();
        crossing_slots.clear();
        let mut widest = 0.0_f32;
        let mut longest_edge = 0.0_f32;
        trees.resize_with(bodies.len(), PlacedTree::default);
        is_crossing.resize_with(bodies.len(), Vec::new);
        for ((place, body), is_crossing) in bodies.iter().enumerate().zip(is_crossing) {
            is_crossing.clear();
            if !has_triangles(body) {
                continue;
            }
            is_crossing.resize(body.particles.inverse_mass.len(), false);
            let tree = body.topology.surface_tree();
            widest = widest.max(2.0 * body.settings.thickness);
            longest_edge = longest_edge.max(tree.longest_edge);
            let places = &places[place];
            tree.place(&mut trees[place], |element| {
                let corners = element.slots.map(|slot| places[slot as usize]);
                [corners.map(|corner| corner.now), corners.map(|corner| corner.start)]
            });
        }
        let skin = SKIN * widest + SKIN_OF_EDGE * longest_edge;
        *holds_until = Some(motion + skin);
        let margin = widest * (1.0 + CONTACT_SLACK) + skin;
        let placed =
            |place: usize| PlacedSurface { tree: bodies[place].topology.surface_tree(), at: &trees[place] };
        for a in (0..bodies.len()).filter(|&a| has_triangles(&bodies[a])) {
            placed(a).own_pairs(margin, &mut |p, q| {
                let elements = [p.min(q), p.max(q)];
                let parts = own_parts(&bodies[a], elements);
                if parts & !MAY_CROSS != 0 {
                    pairs.push(Pair { bodies: [a as u32; 2], elements: elements.map(|e| e as u32), parts });
                }
            });
            let may_touch =
                |b: &usize| has_triangles(&bodies[*b]) && bodies[a].layers.interact(bodies[*b].layers);
            for b in (a + 1..bodies.len()).filter(may_touch) {
                placed(a).pairs_with(&placed(b), margin, &mut |p, q| {
                    let elements = [&placed(a).tree.elements[p], &placed(b).tree.elements[q]];
                    let parts = all_parts(elements);
                    if parts != 0 {
                        pairs.push(Pair {
                            bodies: [a as u32, b as u32],
                            elements: [p as u32, q as u32],
                            parts,
                        });
                    }
                });
            }
        }
        // So that the order in which they are projected does not tell when they were listed.
        pairs.sort_unstable();
        wake_at.resize(pairs.len(), f32::NEG_INFINITY);
    }

    /// Picks the pairs that are near enough to touch or cross.
    fn wake(&mut self, bodies: &[Body], motion: &Motion) {
        let Self { places, pairs, wake_at, awake, crossings: found, is_crossing, crossing_slots, .. } = self;
        awake.clear();
        found.clear();
        for corner in crossing_slots.drain(..) {
            is_crossing[corner.body as usize][corner.slot as usize] = false;
        }
        for (&pair, wake_at) in pairs.iter().zip(wake_at) {
            if motion.now < *wake_at {
                continue;
            }
            let corners = pair.corners(bodies);
            let at = corners.map(|own| own.map(|corner| places[corner.body as usize][corner.slot as usize]));
            let start = at.map(|own| own.map(|place| place.start));
            let apart = pair.apart(bodies);
            let reach = apart * (1.0 + CONTACT_SLACK);
            let flight = greatest_approach(at.map(|own| own.map(|place| place.now - place.start)));
            let enough = reach + flight.max(apart * SLACK_OF_SUBSTEPS);
            let distance = separation(start, enough);
            if distance >= enough {
                *wake_at = motion.at_start + (distance * 0.9999 - reach);
                continue;
            }
            awake.push(Awake { pair, flight });
            if distance <= 0.0 && pair.parts & MAY_CROSS != 0 {
                let before = found.len();
                crossings(corners, start, found);
                for crossing in &found[before..] {
                    for corner in crossing.corners() {
                        is_crossing[corner.body as usize][corner.slot as usize] = true;
                        crossing_slots.push(corner);
                    }
                }
            }
        }
    }

    /// Picks the parts of those that may touch, before things have moved by the slack of substeps.
    fn find_near(&mut self, bodies: &[Body], motion: &Motion) {
        let Self { places, awake, is_crossing, near, kinds, .. } = self;
        near.clear();
        kinds.clear();
        let at_crossing = |corner: &Corner| is_crossing[corner.body as usize][corner.slot as usize];
        let mut least = f32::INFINITY;
        for body in bodies.iter().filter(|body| has_triangles(body)) {
            least = least.min(2.0 * body.settings.thickness);
        }
        self.found_until = motion.at_start + least * SLACK_OF_SUBSTEPS;
        for &Awake { pair, flight } in &*awake {
            let apart = pair.apart(bodies);
            let reach = apart * (1.0 + CONTACT_SLACK) + flight.max(apart * SLACK_OF_SUBSTEPS);
            pair.for_each_part(bodies, |kind, corners| {
                if corners.iter().all(at_crossing) {
                    return;
                }
                let start = corners.map(|corner| places[corner.body as usize][corner.slot as usize].start);
                let weights = kind.nearest(start);
                if weighted(weights, start).length_squared() < reach * reach {
                    near.push(ClothContact::new(corners, apart));
                    kinds.push(kind);
                }
            });
        }
    }

    /// Moves apart what overlaps, and back what has passed: again and again while something has, as what leads one back
    /// may push another through. A heap that no order of projections sorts out is left to the next steps.
    pub fn project(&mut self, bodies: &mut [Body], rate: PushOutRate) {
        for _ in 1..MOST_PASSES {
            if !self.project_once(bodies, rate) || self.repeats_left == 0 {
                return;
            }
            self.repeats_left -= 1;
        }
        self.project_once(bodies, rate);
    }

    /// True if something had passed through something.
    fn project_once(&mut self, bodies: &mut [Body], rate: PushOutRate) -> bool {
        let mut has_passed = false;
        let origin = bodies.first().map_or(Vec3::ZERO, |body| body.particles.origin);
        for (contact, &kind) in self.near.iter_mut().zip(&self.kinds) {
            let now = contact.corners.map(|corner| corner.position(bodies, origin));
            let start = contact.corners.map(|corner| corner.start(bodies, origin));
            if let Some(found) = kind.meet(Passage { start, now }, contact.apart) {
                has_passed |= found.depth > contact.apart;
                contact.push(bodies, rate, found);
            }
        }
        has_passed
    }

    /// Friction between what touched.
    pub fn apply_friction(&self, bodies: &mut [Body]) {
        self.near.iter().for_each(|contact| contact.apply_friction(bodies));
    }
}

impl Pair {
    fn elements<'a>(&self, bodies: &'a [Body]) -> [&'a SurfaceElement; 2] {
        [0, 1].map(|k| {
            let tree = bodies[self.bodies[k] as usize].topology.surface_tree();
            &tree.elements[self.elements[k] as usize]
        })
    }

    fn corners(&self, bodies: &[Body]) -> [[Corner; 3]; 2] {
        let [a, b] = self.elements(bodies);
        [corners_of(a, self.bodies[0]), corners_of(b, self.bodies[1])]
    }

    /// The distance that the two keep, in metres.
    fn apart(&self, bodies: &[Body]) -> f32 {
        self.bodies.iter().map(|&body| bodies[body as usize].settings.thickness).sum()
    }

    fn for_each_part(&self, bodies: &[Body], mut look: impl FnMut(Kind, [Corner; 4])) {
        let [a, b] = self.corners(bodies);
        for k in 0..3 {
            if self.parts & (1 << k) != 0 {
                look(Kind::CornerFace, [a[k], b[0], b[1], b[2]]);
            }
            if self.parts & (8 << k) != 0 {
                look(Kind::CornerFace, [b[k], a[0], a[1], a[2]]);
            }
        }
        for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
            if self.parts & edge_part(j, k) != 0 {
                let ([p, q], [r, s]) = (SurfaceElement::edge(j), SurfaceElement::edge(k));
                look(Kind::EdgeEdge, [a[p], a[q], b[r], b[s]]);
            }
        }
    }
}

impl Kind {
    /// Weights of the two nearest points.
    fn nearest(self, [a, b, c, d]: [Vec3; 4]) -> [f32; 4] {
        match self {
            Self::CornerFace => {
                let [u, v, w] = on_triangle([b, c, d], a);
                [1.0, -u, -v, -w]
            }
            Self::EdgeEdge => {
                let [s, t] = between_segments([a, b], [c, d]);
                [1.0 - s, s, t - 1.0, -t]
            }
        }
    }

    /// How the two overlap, if they do.
    fn meet(self, passage: Passage, apart: f32) -> Option<Penetration<4>> {
        let slack = CRACK_SLACK * apart;
        let passed = match self {
            Self::CornerFace => face_passed(&passage, slack),
            Self::EdgeEdge => edges_passed(&passage, slack),
        };
        let Passage { start, now } = passage;
        let meeting = |weights, normal: Vec3, height: f32| Penetration {
            weights,
            normal,
            depth: apart - height,
            outward: height - weighted(weights, start).dot(normal),
            at_start: apart - weighted(self.nearest(start), start).length(),
        };
        if let Some((weights, normal)) = passed {
            let height = weighted(weights, now).dot(normal);
            return (height < apart).then(|| meeting(weights, normal, height));
        }
        let weights = self.nearest(now);
        let way = weighted(weights, now);
        let distance_squared = way.length_squared();
        // What touches without a distance has no direction: it is left to others around.
        if distance_squared >= apart * apart || distance_squared == 0.0 {
            return None;
        }
        let distance = distance_squared.sqrt();
        Some(meeting(weights, way / distance, distance))
    }
}

/// How many substeps two bodies need that fly at each other: what passes deep through sheds its velocity on many corners
/// that have passed as well, and no order of projections sorts them out; shallow passages are led back.
pub(crate) fn hit_substeps(bodies: &[Body], dt: f32) -> f32 {
    let mut wanted = 0.0_f32;
    for (place, a) in bodies.iter().enumerate().filter(|(_, body)| has_triangles(body)) {
        for b in bodies[place + 1..].iter().filter(|body| has_triangles(body)) {
            let [(low_a, high_a), (low_b, high_b)] = [a, b].map(|body| body.particles.bounds());
            let apart = a.settings.thickness + b.settings.thickness;
            let path = (a.particles.greatest_speed() + b.particles.greatest_speed()) * dt;
            let reach = path + apart;
            if !((low_a - reach).cmple(high_b) & (high_a + reach).cmpge(low_b)).all() {
                continue;
            }
            let edge = a.topology.longest_edge.min(b.topology.longest_edge);
            let most = apart.max(PATH_OF_SUBSTEP * edge);
            // The exact speed is worth a look at all particles only where it may matter.
            if path > most {
                let way = a.particles.mean_velocity() - b.particles.mean_velocity();
                wanted = wanted.max(way.length() * dt / most);
            }
        }
    }
    wanted
}

/// The part of an edge's length that two bodies may fly at each other in a substep.
const PATH_OF_SUBSTEP: f32 = 0.25;

/// Projections of a substep at most, where things pass each other.
const MOST_PASSES: u32 = 32;

/// Repeated projections of a step at most, over all of its substeps.
const MOST_REPEATS: u32 = 256;

/// How far beside a triangle or an edge the way may lead that still passes it, in distances that are kept: closes the
/// cracks between them.
const CRACK_SLACK: f32 = 0.1;

fn weighted(weights: [f32; 4], points: [Vec3; 4]) -> Vec3 {
    points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2] + points[3] * weights[3]
}

fn corners_of(element: &SurfaceElement, body: u32) -> [Corner; 3] {
    element.slots.map(|slot| Corner { body, slot })
}

/// Bound on how far two elements whose corners move by these ways come nearer.
fn greatest_approach([a, b]: [[Vec3; 3]; 2]) -> f32 {
    let between = a.iter().flat_map(|p| b.iter().map(move |q| p.distance_squared(*q)));
    between.fold(0.0, f32::max).sqrt()
}

fn edge_part(j: usize, k: usize) -> u16 {
    1 << (6 + 3 * j + k)
}

/// What is looked at of two elements that have nothing to do with each other at rest.
fn all_parts([a, b]: [&SurfaceElement; 2]) -> u16 {
    let mut parts = 0;
    if b.is_face() {
        parts |= u16::from(a.corners);
    }
    if a.is_face() {
        parts |= u16::from(b.corners) << 3;
    }
    for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
        if a.edges & (1 << j) != 0 && b.edges & (1 << k) != 0 {
            parts |= edge_part(j, k);
        }
    }
    // Two links cannot cross.
    if a.is_face() || b.is_face() { parts | MAY_CROSS } else { parts }
}

/// The same for two elements of one body: without what shares a corner, or is as near at rest.
fn own_parts(body: &Body, elements: [usize; 2]) -> u16 {
    let topology = &body.topology;
    let [a, b] = elements.map(|place| &topology.surface_tree().elements[place]);
    let mut parts = all_parts([a, b]);
    let shares = |p: &[usize], q: &[usize]| p.iter().any(|&i| q.iter().any(|&j| a.slots[i] == b.slots[j]));
    if shares(&[0, 1, 2], &[0, 1, 2]) {
        parts &= !MAY_CROSS;
    }
    let near = 2.0 * body.settings.thickness * NEIGHBOURS_AT_REST;
    let rest = |element: &SurfaceElement| {
        element.indices.map(|index| topology.rest.get(index as usize).copied().unwrap_or_default())
    };
    let (p, q) = (rest(a), rest(b));
    let is_near = |kind: Kind, corners: [Vec3; 4]| {
        weighted(kind.nearest(corners), corners).length_squared() < near * near
    };
    for k in 0..3 {
        let on_b = || shares(&[k], &[0, 1, 2]) || is_near(Kind::CornerFace, [p[k], q[0], q[1], q[2]]);
        let on_a = || shares(&[0, 1, 2], &[k]) || is_near(Kind::CornerFace, [q[k], p[0], p[1], p[2]]);
        if parts & (1 << k) != 0 && on_b() {
            parts &= !(1 << k);
        }
        if parts & (8 << k) != 0 && on_a() {
            parts &= !(8 << k);
        }
    }
    for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
        let (own, other) = (SurfaceElement::edge(j), SurfaceElement::edge(k));
        let corners = [p[own[0]], p[own[1]], q[other[0]], q[other[1]]];
        if parts & edge_part(j, k) != 0 && (shares(&own, &other) || is_near(Kind::EdgeEdge, corners)) {
            parts &= !edge_part(j, k);
        }
    }
    parts
}
