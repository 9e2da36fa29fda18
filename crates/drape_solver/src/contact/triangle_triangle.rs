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
//! Parts that have passed through within the substep are moved back to their own side: the normal is then that of the
//! place and time of passing. Layers that cross when a substep begins have no such side, and contacts would hold them
//! tangled. So contacts whose corners all lie at a crossing are skipped, and the crossing is moved apart instead, in
//! position only (`untangle.rs`).
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::broad_phase::relative_motion::{Motion, RelativeMotion};
use crate::broad_phase::surface_pairs::{PlacedSurface, PlacedTree};
use crate::constants::{CONTACT_SLACK, SKIN, SKIN_OF_EDGE, SLACK_OF_SUBSTEPS, UNTANGLING_SPEED};
use crate::contact::ccd::Passage;
use crate::contact::cloth_contact::{ClothContact, Corner, has_triangles};
use crate::contact::depenetration::PushOutRate;
use crate::contact::triangle_pair::{Kind, MAY_CROSS, Pair, all_parts, own_parts};
use crate::contact::untangle::{CrossedFaces, crossings};
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::separation::separation;
use crate::state::body::Body;

/// The triangles of an island that may touch each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct TrianglePairs {
    /// For each body, the boxes of its patches.
    trees: Vec<PlacedTree>,
    /// For each body, the places of its particles, by slot.
    places: Vec<Vec<CornerPlaces>>,
    pairs: Vec<Pair>,
    /// For each pair the relative motion in metres at which it must be tested again.
    wake_at: Vec<f32>,
    /// Relative motion in metres up to which the list holds; none if there is no list.
    holds_until: Option<f32>,
    /// Relative motion in metres up to which `near` holds all that may touch.
    found_until: f32,
    /// Pairs that are near enough to be tested.
    awake: Vec<Awake>,
    /// Edges through faces, when the substep began.
    crossings: Vec<CrossedFaces>,
    /// For each body and slot, true at a crossing; and a list of these slots.
    is_crossing: Vec<Vec<bool>>,
    crossing_slots: Vec<Corner>,
    /// Contacts that may touch in this substep.
    near: Vec<ClothContact<4>>,
    kinds: Vec<Kind>,
    /// The number of repeated projections that are left in this step.
    repeats_left: u32,
}

/// The place of a particle when the substep began, and after free flight.
#[derive(Clone, Copy, Debug)]
struct CornerPlaces {
    start: Vec3,
    now: Vec3,
}

#[derive(Clone, Copy, Debug)]
struct Awake {
    pair: Pair,
    /// Greatest approach of the two in this substep's free flight, in metres.
    flight: f32,
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

    /// True if anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        !self.near.is_empty()
    }

    /// Contacts that may touch in this substep.
    pub fn near(&self) -> &[ClothContact<4>] {
        &self.near
    }

    /// The number of pairs that are watched.
    pub fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// Finds contacts that may touch in this substep, and moves crossings apart.
    pub fn begin_substep(&mut self, bodies: &mut [Body], motion: &RelativeMotion, rate: PushOutRate) {
        if !bodies.iter().any(has_triangles) {
            self.clear();
            return;
        }
        // Each step makes new lists, so that no step depends on another.
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
        self.crossings.iter().for_each(|crossing| crossing.move_apart(bodies, way));
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
        // Sorted, so that the order of projections does not depend on when the pairs were listed.
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

    /// Picks the parts that may touch before anything has moved by the slack of substeps.
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

    /// Moves overlapping parts apart, and parts that have passed back. It repeats while anything has passed, because
    /// moving one part back may push another through. A heap that no order of projections separates is left to the next
    /// steps.
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
            if let Some(found) = kind.penetration(Passage { start, now }, contact.apart) {
                has_passed |= found.depth > contact.apart;
                contact.push(bodies, rate, found);
            }
        }
        has_passed
    }

    /// Friction between parts that touched.
    pub fn apply_friction(&self, bodies: &mut [Body]) {
        self.near.iter().for_each(|contact| contact.apply_friction(bodies));
    }
}

/// Greatest number of projections in a substep in which parts pass each other.
const MOST_PASSES: u32 = 32;

/// Greatest number of repeated projections in a step, over all of its substeps.
const MOST_REPEATS: u32 = 256;

/// Upper bound in metres on the approach of two elements whose corners move by these ways.
fn greatest_approach([a, b]: [[Vec3; 3]; 2]) -> f32 {
    let between = a.iter().flat_map(|p| b.iter().map(move |q| p.distance_squared(*q)));
    between.fold(0.0, f32::max).sqrt()
}
