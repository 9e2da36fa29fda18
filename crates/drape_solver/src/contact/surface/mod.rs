//! Surfaces against each other and themselves: corners on faces, edges on edges.
//!
//! ```text
//! begin_substep   places before anything moves
//! detect          after the sticks: the list, if it holds no more; crossings; the contacts of this substep
//! project         moves contacts apart, in turn with obstacles; the last time with friction
//! keep_apart      the last stage of a substep: nothing has passed through anything
//! ```
//!
//! The list is made when a step begins, so that no step depends on another, and again when something has left the way that
//! the list expects. Layers that cross when a step begins have no side on which a contact could hold them: contacts whose
//! corners all lie at a crossing are left out, and the crossing is led apart instead.
//!
//! Design: `docs/design/self_contact.md`.

pub(crate) mod contact;
pub(crate) mod crossing;
pub(crate) mod narrow;
pub(crate) mod pair;
pub(crate) mod placed;
pub(crate) mod points;
pub(crate) mod rows;
pub(crate) mod search;
pub(crate) mod truncation;

use glam::Vec3;

use crate::constants::{
    BLUNT_EDGES, CONTACT_MARGIN_OF_SURFACES, RECOVERY_SPEED, REST_SHARE, RISKY_GAP, SLACK_OF_SURFACES,
    UNTANGLING_SPEED,
};
use crate::contact::cloth_contact::has_triangles;
use crate::contact::depenetration::PushOutRate;
use crate::contact::surface::contact::Contact;
use crate::contact::surface::crossing::{Crossing, FindCrossings};
use crate::contact::surface::narrow::{Narrow, RestDistances};
use crate::contact::surface::pair::{Kind, Pair};
use crate::contact::surface::placed::PlacedSurfaces;
use crate::contact::surface::points::Points;
use crate::contact::surface::search::{Reach, Search};
use crate::contact::surface::truncation::{Pieces, truncate};
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// Contacts between the surfaces of an island.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceContacts {
    points: Points,
    surfaces: PlacedSurfaces,
    star_pairs: Vec<[u32; 2]>,
    /// Corners and faces, and edges, that may touch while the list holds.
    pairs: [Vec<Pair>; 2],
    found: [Vec<Pair>; 2],
    list: Option<List>,
    targets: Vec<Vec3>,
    rest_distances: Vec<f32>,
    crossings: Vec<Crossing>,
    is_crossing: Vec<bool>,
    contacts: Vec<Contact>,
    /// Places for which the contacts were found.
    looked_at: Vec<Vec3>,
    pieces: Pieces,
    counts: Counts,
}

/// How long a list holds.
#[derive(Clone, Copy, Debug)]
struct List {
    /// Substeps for which it was made, and those that have passed.
    substeps: u32,
    age: u32,
    /// Metres that corners may be off the way that it expects.
    slack: f32,
}

impl List {
    /// The fraction of its way at the end of the substep that runs now.
    fn fraction(&self) -> f32 {
        (self.age + 1) as f32 / self.substeps as f32
    }
}

/// What happened in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
    /// Lists that were made.
    pub lists: u32,
    /// Pairs that were moved back because they would have passed.
    pub truncated: u32,
    /// Substeps in which some pair could not be kept apart.
    pub unfinished: u32,
}

/// Kinds of pairs, in the order of their lists.
const KINDS: [Kind; 2] = [Kind::CornerFace, Kind::EdgeEdge];

impl SurfaceContacts {
    /// Forgets all contacts.
    pub fn clear(&mut self) {
        self.points.clear();
        self.list = None;
        self.pairs.iter_mut().for_each(Vec::clear);
        self.contacts.clear();
    }

    /// True if anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        self.contacts.iter().any(|contact| contact.may_push)
    }

    /// The number of pairs that are watched.
    pub fn pair_count(&self) -> usize {
        self.pairs.iter().map(Vec::len).sum()
    }

    /// Particles of different bodies that were pushed apart in the last substep: see
    /// [`SelfContacts::pushed_bodies`](crate::contact::cloth_cloth::SelfContacts::pushed_bodies).
    pub fn pushed_bodies(&self) -> impl Iterator<Item = ([(usize, usize); 2], Vec3, f32)> + '_ {
        self.contacts.iter().filter_map(|contact| contact.pushed_bodies(&self.points))
    }

    /// Notes where everything is, before it moves.
    pub fn begin_substep(&mut self, bodies: &[Body], is_first: bool) {
        if !bodies.iter().any(has_triangles) {
            self.clear();
            return;
        }
        self.points.begin_substep(bodies);
        self.contacts.clear();
        if is_first {
            self.surfaces.fit(bodies, &self.points);
            self.surfaces.sharpen(&self.points);
            self.list = None;
            self.counts = Counts::default();
        }
    }

    /// Finds what touches in this substep, after everything has moved; and leads crossings apart.
    pub fn detect(&mut self, bodies: &mut [Body], substep: Substep) {
        if self.points.is_empty() {
            return;
        }
        self.points.read(bodies);
        let holds = self.list.is_some_and(|list| {
            list.age < list.substeps && !self.surfaces.find_stale(&self.points, list.fraction(), list.slack)
        });
        if !holds {
            self.make_list(bodies, substep);
        }
        let way = UNTANGLING_SPEED * substep.duration;
        for crossing in &self.crossings {
            crossing.move_apart(&mut self.points, way);
        }
        self.find_contacts(1.0 + CONTACT_MARGIN_OF_SURFACES, substep.isa);
    }

    /// Lists the pairs that may touch in this substep; in all that are left, if little moves.
    fn make_list(&mut self, bodies: &[Body], substep: Substep) {
        let left = substep.count - substep.index;
        let distance = least_distance(bodies);
        let substeps = if self.fastest() * left as f32 <= distance { left } else { 1 };
        if self.list.is_none() && substeps < left && self.is_nothing_near(bodies, substep, left, distance) {
            return;
        }
        let slack = SLACK_OF_SURFACES * distance;
        self.surfaces.look_at_all();
        self.set_targets(substeps);
        self.pairs.iter_mut().for_each(Vec::clear);
        self.search(bodies, slack, substep.isa);
        if substep.index == 0 {
            self.find_crossings(substep.isa);
        }
        self.list = Some(List { substeps, age: 0, slack });
    }

    /// True if nothing can touch in all substeps that are left, even if corners are farther off their way than usual: the
    /// list is then empty.
    fn is_nothing_near(&mut self, bodies: &[Body], substep: Substep, left: u32, distance: f32) -> bool {
        self.surfaces.look_at_all();
        self.set_targets(left);
        let slack = 2.0 * distance;
        self.surfaces.place(bodies, &self.points, &self.targets, [1.0, slack], substep.isa);
        self.surfaces.star_pairs(bodies, substep.isa, &mut self.star_pairs);
        if !self.star_pairs.is_empty() {
            return false;
        }
        self.pairs.iter_mut().for_each(Vec::clear);
        self.crossings.clear();
        self.list = Some(List { substeps: left, age: 0, slack });
        true
    }

    /// Length in metres of the longest way in this substep, less the mean way.
    fn fastest(&self) -> f32 {
        let points = &self.points;
        let count = points.start.len();
        let mean = (0..count).map(|id| points.way(id)).sum::<Vec3>() / count as f32;
        let squared = |id| (points.way(id) - mean).length_squared();
        (0..count).filter(|&id| points.inverse_mass[id] > 0.0).map(squared).fold(0.0, f32::max).sqrt()
    }

    /// Sets where all points would be after so many substeps like this one.
    fn set_targets(&mut self, substeps: u32) {
        let Self { points, targets, .. } = self;
        targets.clear();
        if substeps == 1 {
            targets.extend_from_slice(&points.end);
        } else {
            let ends = points.start.iter().zip(&points.end);
            targets.extend(ends.map(|(start, end)| *start + (*end - *start) * substeps as f32));
        }
    }

    /// Adds to the list what may touch on the way to the targets, where one of the two is in a leaf that is looked at.
    fn search(&mut self, bodies: &[Body], slack: f32, isa: Isa) {
        let Self { points, surfaces, star_pairs, targets, found, .. } = self;
        self.counts.lists += 1;
        let factor = 1.0 + CONTACT_MARGIN_OF_SURFACES;
        surfaces.place(bodies, points, targets, [factor, slack], isa);
        surfaces.star_pairs(bodies, isa, star_pairs);
        found.iter_mut().for_each(Vec::clear);
        isa.run(Search {
            rows: &surfaces.rows,
            stars: &surfaces.stars,
            pairs: star_pairs,
            reach: Reach { factor, blunt_factor: BLUNT_EDGES * factor, slack: 2.0 * slack },
            found,
        });
        self.keep_found(bodies, isa);
    }

    /// Gives the pairs that were found their distances, and lists them.
    fn keep_found(&mut self, bodies: &[Body], isa: Isa) {
        let Self { points, surfaces, pairs, found, rest_distances, .. } = self;
        for ((kind, found), pairs) in KINDS.into_iter().zip(found).zip(pairs) {
            rest_distances.clear();
            isa.run(RestDistances { kind, pairs: found, rest: &surfaces.rest, found: rest_distances });
            for (pair, &at_rest) in found.iter_mut().zip(&*rest_distances) {
                let [a, b] = [pair.ids[0], pair.ids[3]].map(|id| points.body[id as usize] as usize);
                let full = bodies[a].settings.thickness + bodies[b].settings.thickness;
                // Neighbours within a body keep less, so that sticks that are a little shorter do not work against
                // contacts.
                let full = if a == b { full.min(REST_SHARE * at_rest) } else { full };
                pair.distance = full * (BLUNT_EDGES + (1.0 - BLUNT_EDGES) * pair.sharpness);
            }
            pairs.extend(found.iter().filter(|pair| pair.distance > 0.0));
        }
    }

    /// Finds the edges that pass through faces when the step begins.
    fn find_crossings(&mut self, isa: Isa) {
        let Self { points, surfaces, star_pairs, crossings, is_crossing, .. } = self;
        crossings.clear();
        let PlacedSurfaces { rows, stars, .. } = &*surfaces;
        isa.run(FindCrossings { rows, stars, pairs: star_pairs, found: crossings });
        is_crossing.clear();
        is_crossing.resize(points.start.len(), false);
        for corner in crossings.iter().flat_map(Crossing::corners) {
            is_crossing[corner as usize] = true;
        }
    }

    /// Finds the contacts among the pairs: those that come nearer than the distance that they keep, times `touching`, and
    /// those that may pass each other.
    fn find_contacts(&mut self, touching: f32, isa: Isa) {
        let Self { points, pairs, contacts, crossings, is_crossing, looked_at, .. } = self;
        contacts.retain(|contact| contact.may_push);
        let old = contacts.len();
        for (kind, pairs) in KINDS.into_iter().zip(pairs) {
            let places = [&points.start[..], &points.end[..]];
            isa.run(Narrow { kind, pairs, places, touching, risky: RISKY_GAP, found: contacts });
        }
        if !crossings.is_empty() {
            let mut place = 0;
            contacts.retain(|contact| {
                place += 1;
                place <= old || !contact.pair.ids.iter().all(|&id| is_crossing[id as usize])
            });
        }
        looked_at.clone_from(&points.end);
    }

    /// Moves contacts apart once; with friction in the last projection of the substep.
    pub fn project(&mut self, bodies: &mut [Body], rate: PushOutRate, is_last: bool) {
        if self.contacts.is_empty() {
            return;
        }
        let Self { points, contacts, .. } = self;
        points.read(bodies);
        let recovery = RECOVERY_SPEED * rate.substep();
        for contact in contacts.iter_mut().filter(|contact| contact.may_push) {
            contact.push(points, recovery);
        }
        if is_last {
            contacts.iter().for_each(|contact| contact.apply_friction(points, bodies));
        }
        self.write(bodies);
    }

    /// Moves the bodies' particles; what was moved in position only gets no velocity.
    fn write(&mut self, bodies: &mut [Body]) {
        self.points.write(bodies, |body, slot, way| body.particles.position.add(slot, way));
        self.points.write_shifts(bodies);
    }

    /// The end of the substep: moves back what would have passed through something.
    pub fn keep_apart(&mut self, bodies: &mut [Body], substep: Substep) {
        let Some(mut list) = self.list else { return };
        if self.points.is_empty() {
            return;
        }
        self.points.read(bodies);
        let distance = least_distance(bodies);
        for attempt in 0..ATTEMPTS {
            let tolerance = list.slack + 0.5 * BLUNT_EDGES * distance;
            if self.surfaces.find_stale(&self.points, list.fraction(), tolerance) {
                // The next substep makes a new list.
                (list.substeps, list.age) = (1, 0);
                self.set_targets(1);
                let slack = SLACK_OF_SURFACES * distance;
                list.slack = slack;
                self.search(bodies, slack, substep.isa);
                self.find_contacts(f32::NEG_INFINITY, substep.isa);
            } else if self.moved() > 0.5 * RISKY_GAP * BLUNT_EDGES * distance {
                self.find_contacts(f32::NEG_INFINITY, substep.isa);
            } else if attempt > 0 {
                break;
            }
            let (count, is_done) = truncate(&self.contacts, &mut self.points, &mut self.pieces);
            self.counts.truncated += count;
            self.counts.unfinished += u32::from(!is_done || attempt == ATTEMPTS - 1);
            if count == 0 {
                break;
            }
        }
        self.points.write(bodies, |body, slot, way| {
            body.particles.position.add(slot, way);
            body.particles.displacement.add(slot, way);
        });
        self.list = Some(List { age: list.age + 1, ..list });
    }

    /// Greatest distance in metres of a point from where it was when the contacts were found.
    fn moved(&self) -> f32 {
        let ways = self.points.end.iter().zip(&self.looked_at);
        ways.map(|(end, at)| end.distance_squared(*at)).fold(0.0, f32::max).sqrt()
    }
}

/// Rounds of truncation. What they move may come near something that was not looked at.
const ATTEMPTS: u32 = 8;

/// Distance in metres that the two thinnest surfaces keep.
fn least_distance(bodies: &[Body]) -> f32 {
    let thin = bodies.iter().filter(|body| has_triangles(body)).map(|body| 2.0 * body.settings.thickness);
    thin.fold(f32::INFINITY, f32::min)
}
