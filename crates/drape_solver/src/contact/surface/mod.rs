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

pub(crate) mod blocks;
pub(crate) mod calm;
pub(crate) mod contact;
pub(crate) mod counts;
pub(crate) mod crossing;
pub(crate) mod deviation;
pub(crate) mod leaves;
pub(crate) mod list;
pub(crate) mod narrow;
pub(crate) mod pair;
pub(crate) mod pins;
pub(crate) mod placed;
pub(crate) mod placed_body;
pub(crate) mod points;
pub(crate) mod reach;
pub(crate) mod rows;
pub(crate) mod search;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod truncation;

use glam::{Vec3, Vec4};

use crate::constants::{
    LEAST_SHARED_PAIRS, MARGIN_IN_FREE_FLIGHT, RECOVERY_SPEED, RISKY_GAP, UNTANGLING_SPEED,
};
use crate::contact::surface::calm::Calm;
use crate::contact::surface::contact::Contact;
use crate::contact::surface::counts::SelfContactCounts;
use crate::contact::surface::crossing::Crossing;
use crate::contact::surface::list::PairList;
use crate::contact::surface::narrow::{Found, Narrow};
use crate::contact::surface::pair::{KINDS, Pair};
use crate::contact::surface::placed::PlacedSurfaces;
use crate::contact::surface::points::Points;
use crate::contact::surface::truncation::Truncation;
use crate::parallel::gather::{Spare, gather};
use crate::parallel::workers::Workers;
use crate::simd::columns::{Cell, Columns, LANES};
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::star::NONE;
use crate::state::substep::Substep;

/// Contacts between the surfaces of an island.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceContacts {
    points: Points,
    /// Places of all particles when the step began.
    step_starts: Vec<Cell>,
    surfaces: PlacedSurfaces,
    calm: Calm,
    list: PairList,
    crossings: Vec<Crossing>,
    is_crossing: Vec<bool>,
    found: Found,
    spare: Spare<Found>,
    /// Places for which the contacts were found.
    looked_at: Vec<Vec4>,
    /// True for points that have moved since.
    has_moved: Vec<bool>,
    suspects: Vec<Pair>,
    truncation: Truncation,
    counts: SelfContactCounts,
}

impl SurfaceContacts {
    /// Forgets all contacts.
    pub fn clear(&mut self) {
        self.points.clear();
        self.calm.end();
        self.list.clear();
        self.found.clear();
    }

    /// True if anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        !self.found.contacts.is_empty()
    }

    /// The work of the last step.
    pub fn counts(&self) -> SelfContactCounts {
        SelfContactCounts { pairs: self.list.pairs.iter().map(Vec::len).sum(), ..self.counts }
    }

    /// Mean of the squared ways of the free particles of the body at this `place` in the step, in m²; none if nothing touched.
    pub fn mean_square_way(&self, place: usize, body: &Body) -> Option<f32> {
        let first = self.points.first.get(place).filter(|&&first| first != NONE && self.is_near())?;
        let starts = &self.step_starts[*first as usize / LANES..];
        let free =
            body.particles.inverse_mass.iter().enumerate().filter(|(_, inverse_mass)| **inverse_mass > 0.0);
        let way = |slot: usize| body.particles.position.get(slot) - starts[slot / LANES].get(slot % LANES);
        let (count, sum) =
            free.fold((0.0, 0.0), |(count, sum), (slot, _)| (count + 1.0, sum + way(slot).length_squared()));
        Some(sum / f32::max(count, 1.0))
    }

    /// Particles of different bodies that were pushed apart in the last substep: each as its body and slot, the unit normal
    /// from the second to the first, and the depth in metres, summed over the projections of the substep. Edges and faces
    /// count as their nearest particles.
    pub fn pushed_bodies(&self) -> impl Iterator<Item = ([(usize, usize); 2], Vec3, f32)> + '_ {
        self.found.contacts.iter().filter_map(|contact| contact.pushed_bodies(&self.points))
    }

    /// Notes where everything is, before it moves.
    pub fn begin_substep(&mut self, bodies: &[Body], is_first: bool) {
        if !bodies.iter().any(Body::has_self_contact) {
            self.clear();
            return;
        }
        self.points.begin_substep(bodies);
        self.found.clear();
        if is_first {
            self.step_starts.clone_from(&self.points.start_cells);
            self.begin_step();
        }
    }

    fn begin_step(&mut self) {
        self.calm.end();
        self.list.clear();
        self.crossings.clear();
        self.counts = SelfContactCounts::default();
    }

    /// Before anything moves: true if nothing is expected to touch in the whole step, with which the bodies' watches begin.
    pub fn expects_calm(&mut self, bodies: &mut [Body], substep: Substep) -> bool {
        if !bodies.iter().any(Body::has_self_contact) {
            self.clear();
            return true;
        }
        // Frames take particles along on ways that their displacements do not show.
        if substep.index > 0 || bodies.iter().any(|body| body.context.frame.is_some()) {
            return false;
        }
        self.points.number(bodies);
        self.found.clear();
        self.begin_step();
        for Body { particles, context, .. } in bodies.iter_mut().filter(|body| body.has_self_contact()) {
            context.watch.prepare(&particles.position.cells, &particles.displacement.cells, 0);
        }
        let distance = least_distance(bodies);
        self.calm.begin(&mut self.surfaces, &self.points, bodies, substep.count, distance, substep.isa);
        self.calm.holds_for(substep.count)
    }

    /// After a whole step that was expected to be calm: true if it was. If not, everything is where it was when it began.
    pub fn was_calm(&mut self, bodies: &mut [Body], isa: Isa) -> bool {
        let was_calm = self.calm.is_on_its_way(bodies, isa);
        for Body { particles, context, .. } in bodies.iter_mut().filter(|body| body.has_self_contact()) {
            if !was_calm {
                particles.position.cells.copy_from_slice(&context.watch.starts);
                particles.displacement.cells.copy_from_slice(&context.watch.ways);
            }
            context.watch.end();
        }
        was_calm
    }

    /// Finds what touches in free flight, where a rope takes part.
    pub fn detect_on_ropes(&mut self, bodies: &mut [Body], substep: Substep, workers: &Workers) {
        if is_on_ropes(bodies) {
            self.detect(bodies, substep, MARGIN_IN_FREE_FLIGHT, workers);
        }
    }

    /// Finds what touches in this substep, within a `margin` (part of the distance to keep), after everything has moved; and
    /// leads crossings apart.
    pub fn detect(&mut self, bodies: &mut [Body], substep: Substep, margin: f32, workers: &Workers) {
        if self.points.is_empty() || self.is_calm(bodies, substep) {
            return;
        }
        self.points.read_starts(bodies);
        self.points.read(bodies, |body| &body.context.integrated);
        self.points.read_flight(bodies);
        // Contacts of ropes that were found in free flight have pushed in each iteration.
        if !self.found.contacts.is_empty() {
            self.apply_friction(bodies);
            self.write(bodies);
        }
        if !self.list.holds() {
            self.make_list(bodies, substep, workers);
        }
        if !self.crossings.is_empty() {
            let way = UNTANGLING_SPEED * substep.duration;
            self.crossings.iter().for_each(|crossing| crossing.move_apart(&mut self.points, way));
            self.write(bodies);
        }
        self.find_contacts(bodies, margin, substep.isa, workers);
    }

    /// True if nothing can touch in this substep.
    fn is_calm(&mut self, bodies: &mut [Body], substep: Substep) -> bool {
        if !self.calm.holds() && !self.list.holds() {
            self.begin_calm(bodies, |body| &body.context.integrated, substep);
            // Nothing of a list that holds no more is watched.
            self.list.clear();
        }
        self.calm.holds()
    }

    /// Looks whether the rest of the step is calm, if all go on from the start of this substep as they have gone to this `column`.
    fn begin_calm(&mut self, bodies: &mut [Body], column: fn(&Body) -> &Columns, substep: Substep) {
        let Self { calm, surfaces, points, .. } = self;
        points.prepare_watches(bodies, column, substep.index);
        let (left, distance) = (substep.count - substep.index, least_distance(bodies));
        calm.begin(surfaces, points, bodies, left, distance, substep.isa);
    }

    /// Ends a substep in which nothing could touch: false if something may have left its way so far that it does.
    fn stays_calm(&mut self, bodies: &mut [Body], substep: Substep) -> bool {
        if !self.calm.is_on_its_way(bodies, substep.isa) {
            self.begin_calm(bodies, |body| &body.particles.position, substep);
        }
        let is_calm = self.calm.holds();
        if is_calm {
            self.calm.grow_older();
        }
        is_calm
    }

    /// Lists what may touch; and, when the step begins, the edges that pass through faces.
    fn make_list(&mut self, bodies: &[Body], substep: Substep, workers: &Workers) {
        let Self { points, surfaces, list, crossings, is_crossing, counts, .. } = self;
        surfaces.fit(bodies, points);
        counts.lists += 1;
        let distance = least_distance(bodies);
        let of_start = (substep.index == 0).then_some(&mut *crossings);
        list.make(surfaces, points, bodies, substep, distance, of_start, workers);
        counts.crossings = crossings.len() as u32;
        is_crossing.clear();
        is_crossing.resize(points.start.len(), false);
        for corner in crossings.iter().flat_map(Crossing::corners) {
            is_crossing[corner as usize] = true;
        }
    }

    /// Finds the pairs that touch, within a `margin`, and those that may pass each other.
    fn find_contacts(&mut self, bodies: &[Body], margin: f32, isa: Isa, workers: &Workers) {
        let Self { points, surfaces, list, found, spare, looked_at, .. } = self;
        let (points, surfaces) = (&*points, &*surfaces);
        found.clear();
        let (margin, risky_gap) = (Some(margin), RISKY_GAP * least_distance(bodies));
        for (kind, pairs) in KINDS.into_iter().zip(&mut list.pairs) {
            gather(pairs, LEAST_SHARED_PAIRS, workers, spare, found, &|pairs, found| {
                isa.run(Narrow { kind, pairs, surfaces, points, margin, risky_gap, found });
            });
        }
        looked_at.clone_from(&points.end);
        self.leave_out_crossings();
    }

    /// Finds more pairs that may pass each other: those of corners that have moved since they were looked at, and those that
    /// are `new` in the list.
    fn find_passing(&mut self, bodies: &[Body], is_new: bool, isa: Isa, workers: &Workers) {
        let Self { points, surfaces, list, found, spare, looked_at, has_moved, suspects, .. } = self;
        let (points, surfaces) = (&*points, &*surfaces);
        let risky_gap = RISKY_GAP * least_distance(bodies);
        // Four corners may have moved since a pair was looked at, each to either side.
        let least_way = 0.25 * risky_gap;
        has_moved.clear();
        has_moved.extend(points.end.iter().zip(&mut *looked_at).map(|(&end, at)| {
            let has_moved = end.distance_squared(*at) > least_way * least_way;
            if has_moved {
                *at = end;
            }
            has_moved
        }));
        for (k, kind) in KINDS.into_iter().enumerate() {
            let known = if is_new { list.known[k] } else { list.pairs[k].len() };
            let (old, new) = list.pairs[k].split_at(known);
            suspects.clear();
            suspects.extend(old.iter().filter(|pair| pair.ids.iter().any(|&id| has_moved[id as usize])));
            suspects.extend_from_slice(new);
            gather(suspects, LEAST_SHARED_PAIRS, workers, spare, found, &|pairs, found| {
                isa.run(Narrow { kind, pairs, surfaces, points, margin: None, risky_gap, found });
            });
        }
        self.leave_out_crossings();
    }

    /// Pairs whose corners all lie at a crossing have no side on which they could be held.
    fn leave_out_crossings(&mut self) {
        let Self { found: Found { contacts, passing }, crossings, is_crossing, .. } = self;
        if !crossings.is_empty() {
            let has_side = |contact: &Contact| !contact.pair.ids.iter().all(|&id| is_crossing[id as usize]);
            contacts.retain(has_side);
            passing.retain(has_side);
        }
    }

    /// Moves contacts apart once, by `relaxation` times as much as they need.
    pub fn project(&mut self, bodies: &mut [Body], relaxation: f32) {
        if self.found.contacts.is_empty() {
            return;
        }
        let Self { points, found: Found { contacts, .. }, .. } = self;
        points.read(bodies, |body| &body.context.integrated);
        contacts.iter_mut().for_each(|contact| contact.push(points, relaxation));
        self.write(bodies);
    }

    /// After the last projection of a substep: friction, and recovery from overlap.
    pub fn settle(&mut self, bodies: &mut [Body], substep: Substep) {
        self.apply_friction(bodies);
        let Self { points, found: Found { contacts, .. }, .. } = self;
        let way = RECOVERY_SPEED * substep.duration;
        // To and fro, as either may be the way up.
        contacts.iter().chain(contacts.iter().rev()).for_each(|contact| contact.recover(points, way));
        self.write(bodies);
    }

    fn apply_friction(&mut self, bodies: &[Body]) {
        let Self { points, found: Found { contacts, .. }, .. } = self;
        contacts.iter().for_each(|contact| contact.apply_friction(points, bodies));
    }

    /// Moves the bodies' particles; what was moved in position only gets no velocity. Pushes go into the displacement at once:
    /// what positions gain on it later is counted as the work of sticks, which cannot change a body's momentum.
    fn write(&mut self, bodies: &mut [Body]) {
        self.points.write(bodies, |body, slot, way, moving| {
            body.particles.position.add(slot, way);
            body.context.integrated.add(slot, way);
            body.particles.displacement.add(slot, moving);
        });
    }

    /// The end of the substep: moves back what would have passed through something.
    pub fn keep_apart(&mut self, bodies: &mut [Body], substep: Substep, workers: &Workers) {
        let was_calm = self.calm.holds();
        if was_calm {
            if self.stays_calm(bodies, substep) {
                return;
            }
        } else if !self.list.holds() {
            return;
        }
        self.points.read_starts(bodies);
        self.points.read(bodies, |body| &body.particles.position);
        let distance = least_distance(bodies);
        if was_calm {
            let Self { points, surfaces, list, looked_at, counts, .. } = self;
            surfaces.fit(bodies, points);
            list.make_at_end(surfaces, points, bodies, substep, distance, workers);
            counts.lists += 1;
            looked_at.clone_from(&points.end);
        }
        self.truncation.begin();
        for attempt in 1..=ATTEMPTS {
            let Self { points, surfaces, list, counts, .. } = self;
            let is_renewed = list.renew(surfaces, points, bodies, distance, substep.isa, workers);
            let is_new = is_renewed || was_calm && attempt == 1;
            counts.lists += u32::from(is_renewed);
            self.find_passing(bodies, is_new, substep.isa, workers);
            let moves = self.truncation.truncate(&self.found.passing, &mut self.points);
            self.counts.truncated += moves;
            if moves == 0 {
                break;
            }
            self.counts.unfinished += u32::from(attempt == ATTEMPTS);
        }
        self.points.write(bodies, |body, slot, way, moving| {
            body.particles.position.add(slot, way);
            body.particles.displacement.add(slot, moving);
        });
        self.list.grow_older();
    }
}

/// True if a body without faces, such as a rope, has self-contact.
pub(crate) fn is_on_ropes(bodies: &[Body]) -> bool {
    bodies.iter().any(|body| body.has_self_contact() && body.topology.faces().is_empty())
}

/// Rounds of truncation. What they move may come near something that was not looked at.
const ATTEMPTS: u32 = 64;

/// Distance in metres that the two thinnest surfaces keep.
fn least_distance(bodies: &[Body]) -> f32 {
    let thin = bodies.iter().filter(|body| body.has_self_contact()).map(|body| 2.0 * body.settings.thickness);
    thin.fold(f32::INFINITY, f32::min)
}
