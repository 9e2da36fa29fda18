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
pub(crate) mod counts;
pub(crate) mod crossing;
pub(crate) mod narrow;
pub(crate) mod pair;
pub(crate) mod placed;
pub(crate) mod points;
pub(crate) mod reach;
pub(crate) mod rows;
pub(crate) mod search;
pub(crate) mod truncation;

use glam::{Vec3, Vec4};

use crate::broad_phase::surface_pairs::StarPairs;
use crate::constants::{
    CONTACT_MARGIN_OF_SURFACES, RECOVERY_SPEED, RISKY_GAP, SLACK_OF_SURFACES, UNTANGLING_SPEED,
};
use crate::contact::cloth_contact::has_triangles;
use crate::contact::depenetration::PushOutRate;
use crate::contact::surface::contact::Contact;
use crate::contact::surface::counts::SelfContactCounts;
use crate::contact::surface::crossing::{Crossing, FindCrossings};
use crate::contact::surface::narrow::Narrow;
use crate::contact::surface::pair::{Kind, Pair};
use crate::contact::surface::placed::PlacedSurfaces;
use crate::contact::surface::points::Points;
use crate::contact::surface::reach::Reach;
use crate::contact::surface::search::Search;
use crate::contact::surface::truncation::{Pieces, truncate};
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// Contacts between the surfaces of an island.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceContacts {
    points: Points,
    surfaces: PlacedSurfaces,
    star_pairs: StarPairs,
    /// Corners and faces, and edges, that may touch while the list holds.
    pairs: [Vec<Pair>; 2],
    found: [Vec<Pair>; 2],
    list: Option<List>,
    targets: Vec<Vec4>,
    crossings: Vec<Crossing>,
    is_crossing: Vec<bool>,
    /// Pairs that touch in this substep, and pairs that may pass each other.
    contacts: Vec<Contact>,
    passing: Vec<Contact>,
    /// Places for which the contacts were found.
    looked_at: Vec<Vec4>,
    pieces: Pieces,
    counts: SelfContactCounts,
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
        !self.contacts.is_empty()
    }

    /// What happened in the last step.
    pub fn counts(&self) -> SelfContactCounts {
        SelfContactCounts { pairs: self.pairs.iter().map(Vec::len).sum(), ..self.counts }
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
        self.passing.clear();
        if is_first {
            self.surfaces.fit(bodies, &self.points);
            self.surfaces.sharpen(&self.points);
            self.list = None;
            self.counts = SelfContactCounts::default();
        }
    }

    /// Finds what touches in this substep, within a `margin` (part of the distance to keep), after everything has moved; and
    /// leads crossings apart.
    pub fn detect(&mut self, bodies: &mut [Body], substep: Substep, margin: f32) {
        if self.points.is_empty() {
            return;
        }
        self.points.read(bodies);
        self.points.read_flight(bodies);
        // Contacts of ropes that were found in free flight have pushed in each iteration.
        if !self.contacts.is_empty() {
            self.apply_friction(bodies);
            self.write(bodies);
        }
        match self.list {
            Some(list) if list.age < list.substeps => {
                if self.surfaces.find_stale(&self.points, list.fraction(), list.slack) {
                    self.renew_list(bodies, substep, list);
                }
            }
            _ => self.make_list(bodies, substep),
        }
        if !self.crossings.is_empty() {
            let way = UNTANGLING_SPEED * substep.duration;
            self.crossings.iter().for_each(|crossing| crossing.move_apart(&mut self.points, way));
            self.write(bodies);
        }
        self.find_contacts(bodies, Some(margin), substep.isa);
    }

    /// Lists the pairs that may touch in all substeps that are left; in this one alone if many things are unsteady.
    fn make_list(&mut self, bodies: &[Body], substep: Substep) {
        let left = substep.count - substep.index;
        let distance = least_distance(bodies);
        if self.list.is_none() && self.is_nothing_near(bodies, substep, left, distance) {
            return;
        }
        let slack = CALM_SLACK * distance;
        let is_calm = left > 1 && self.unsteady(slack) * FEW < self.points.start.len();
        let (substeps, slack) = if is_calm { (left, slack) } else { (1, SLACK_OF_SURFACES * distance) };
        self.surfaces.look_at_all();
        self.set_targets(substeps, slack);
        self.star_pairs.has_crossings = substep.index == 0;
        self.search(bodies, slack, substep.isa);
        if substep.index == 0 {
            self.find_crossings(substep.isa);
        }
        self.star_pairs.has_crossings = false;
        self.list = Some(List { substeps, age: 0, slack });
    }

    /// Lists the pairs of stars anew that have left the way which the list expects; all pairs, if there are many such stars.
    fn renew_list(&mut self, bodies: &[Body], substep: Substep, list: List) {
        if self.surfaces.stale_count() * FEW > self.surfaces.stars.len() {
            self.make_list(bodies, substep);
            return;
        }
        self.list = Some(self.renew_stale(bodies, substep, list));
    }

    /// Lists the pairs of stale stars anew, for the substeps that are left to the list.
    fn renew_stale(&mut self, bodies: &[Body], substep: Substep, list: List) -> List {
        let substeps = list.substeps - list.age;
        self.set_targets(substeps, list.slack);
        self.search(bodies, list.slack, substep.isa);
        List { substeps, age: 0, ..list }
    }

    /// True if nothing can touch in all substeps that are left, even if corners are farther off their way than usual: the
    /// list is then empty.
    fn is_nothing_near(&mut self, bodies: &[Body], substep: Substep, left: u32, distance: f32) -> bool {
        self.surfaces.look_at_all();
        let slack = 2.0 * distance;
        self.set_targets(left, slack);
        let reach = Reach { factor: 1.0, slack, least: 0.0 };
        self.surfaces.place(bodies, &self.points, &self.targets, reach, substep.isa);
        self.surfaces.star_pairs(bodies, substep.isa, &mut self.star_pairs);
        if !self.star_pairs.is_empty() {
            return false;
        }
        self.pairs.iter_mut().for_each(Vec::clear);
        self.crossings.clear();
        self.list = Some(List { substeps: left, age: 0, slack });
        true
    }

    /// The number of points that contacts and sticks move by more than `slack` metres after free flight.
    fn unsteady(&self, slack: f32) -> usize {
        let Points { flight, end, .. } = &self.points;
        let is_pulled = |(flight, end): (&Vec4, &Vec4)| flight.distance_squared(*end) > slack * slack;
        flight.iter().zip(end).filter(|&ways| is_pulled(ways)).count()
    }

    /// Sets where all points are at the end of this substep, or would be after several of free flight. Points that are more
    /// than `slack` metres off their flight go on as in this substep.
    fn set_targets(&mut self, substeps: u32, slack: f32) {
        let Self { points, targets, .. } = self;
        targets.clear();
        if substeps == 1 {
            targets.extend_from_slice(&points.end);
            return;
        }
        targets.extend((0..points.start.len()).map(|id| {
            let (start, flight, end) = (points.start[id], points.flight[id], points.end[id]);
            let is_pulled = flight.distance_squared(end) > slack * slack;
            start + (if is_pulled { end } else { flight } - start) * substeps as f32
        }));
    }

    /// Adds to the list what may touch on the way to the targets, where one of the two is in a leaf that is looked at.
    fn search(&mut self, bodies: &[Body], slack: f32, isa: Isa) {
        let Self { points, surfaces, star_pairs, pairs, targets, found, .. } = self;
        self.counts.lists += 1;
        let reach = Reach { factor: 1.0 + CONTACT_MARGIN_OF_SURFACES, slack, least: 2.0 * PUSH_TOLERANCE };
        surfaces.place(bodies, points, targets, reach, isa);
        surfaces.star_pairs(bodies, isa, star_pairs);
        found.iter_mut().for_each(Vec::clear);
        isa.run(Search {
            rows: &surfaces.rows,
            stars: &surfaces.stars,
            pairs: star_pairs,
            reach: reach.of_two(),
            found,
        });
        for (found, pairs) in found.iter_mut().zip(pairs) {
            pairs.retain(|pair| !surfaces.is_looked_at(pair.stars));
            pairs.append(found);
        }
    }

    /// Finds the edges that pass through faces when the step begins.
    fn find_crossings(&mut self, isa: Isa) {
        let Self { points, surfaces, star_pairs, crossings, is_crossing, .. } = self;
        crossings.clear();
        let PlacedSurfaces { rows, stars, .. } = &*surfaces;
        isa.run(FindCrossings { rows, stars, pairs: &star_pairs.crossings, found: crossings });
        self.counts.crossings = crossings.len() as u32;
        is_crossing.clear();
        is_crossing.resize(points.start.len(), false);
        for corner in crossings.iter().flat_map(Crossing::corners) {
            is_crossing[corner as usize] = true;
        }
    }

    /// Finds the pairs that may pass each other; and those that touch, if so asked.
    fn find_contacts(&mut self, bodies: &[Body], margin: Option<f32>, isa: Isa) {
        let risky_gap = RISKY_GAP * least_distance(bodies);
        let Self { points, surfaces, pairs, contacts, passing, crossings, is_crossing, looked_at, .. } = self;
        passing.clear();
        if margin.is_some() {
            contacts.clear();
        }
        for (kind, pairs) in KINDS.into_iter().zip(pairs) {
            let places = [&points.start[..], &points.end[..]];
            let touching = margin.map(|_| &mut *contacts);
            let margin = margin.unwrap_or_default();
            isa.run(Narrow {
                kind,
                pairs,
                surfaces,
                places,
                flights: &points.flight,
                touching,
                margin,
                risky_gap,
                passing,
            });
        }
        if !crossings.is_empty() {
            let has_side = |contact: &Contact| !contact.pair.ids.iter().all(|&id| is_crossing[id as usize]);
            contacts.retain(has_side);
            passing.retain(has_side);
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
        contacts.iter_mut().for_each(|contact| contact.push(points));
        if is_last {
            self.apply_friction(bodies);
            let Self { points, contacts, .. } = self;
            let way = RECOVERY_SPEED * rate.substep();
            contacts.iter().for_each(|contact| contact.recover(points, way));
        }
        self.write(bodies);
    }

    fn apply_friction(&mut self, bodies: &[Body]) {
        let Self { points, contacts, .. } = self;
        contacts.iter().for_each(|contact| contact.apply_friction(points, bodies));
    }

    /// Moves the bodies' particles; what was moved in position only gets no velocity. Pushes go into the displacement at once:
    /// what positions gain on it later is counted as the work of sticks, which cannot change a body's momentum.
    fn write(&mut self, bodies: &mut [Body]) {
        self.points.write(bodies, |body, slot, way, shift| {
            body.particles.position.add(slot, way);
            body.context.integrated.add(slot, way);
            body.particles.displacement.add(slot, way - shift);
        });
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
            let tolerance = PUSH_TOLERANCE * distance;
            if self.surfaces.find_stale(&self.points, list.fraction(), tolerance) {
                list = self.renew_stale(bodies, substep, list);
                self.find_contacts(bodies, None, substep.isa);
            } else if self.moved() > 0.5 * RISKY_GAP * distance {
                self.find_contacts(bodies, None, substep.isa);
            } else if attempt > 0 {
                break;
            }
            let (count, is_done) = truncate(&self.passing, &mut self.points, &mut self.pieces);
            self.counts.truncated += count;
            self.counts.unfinished += u32::from(!is_done || attempt == ATTEMPTS - 1);
            if count == 0 {
                break;
            }
        }
        self.points.write(bodies, |body, slot, way, _| {
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

/// As [`SLACK_OF_SURFACES`], for lists of several substeps.
const CALM_SLACK: f32 = 0.3;

/// Distance that contacts may push a corner off its way, in distances that they keep, before its pairs are looked for
/// again: pairs are listed if twice that lies between them.
const PUSH_TOLERANCE: f32 = 0.4;

/// Among this many things, one is few.
const FEW: usize = 8;

/// Rounds of truncation. What they move may come near something that was not looked at.
const ATTEMPTS: u32 = 8;

/// Distance in metres that the two thinnest surfaces keep.
fn least_distance(bodies: &[Body]) -> f32 {
    let thin = bodies.iter().filter(|body| has_triangles(body)).map(|body| 2.0 * body.settings.thickness);
    thin.fold(f32::INFINITY, f32::min)
}
