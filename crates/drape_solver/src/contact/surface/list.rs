//! The list of pairs that may touch: made when a step begins, and renewed star by star.
//!
//! The list expects each corner to fly freely for the rest of the step, or for as many substeps as a list holds at most. As
//! long as all are within a slack of that way, a pair that is not listed cannot touch. At the end of a substep the pairs of
//! stars that have left it are looked for anew.
//!
//! ```text
//!     start   1   2   3   4         the way that the list expects
//!       o---- o --o---o---o
//!            (   )  \               within the slack, and off it: this star's pairs are looked for anew
//!                    o
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec4;

use crate::broad_phase::surface_pairs::StarPairSearch;
use crate::constants::{
    CONTACT_MARGIN_OF_SURFACES, LEAST_SHARED_PAIRS, MOST_LISTED_SUBSTEPS, SLACK_OF_SURFACES,
};
use crate::contact::surface::crossing::{Crossing, FindCrossings};
use crate::contact::surface::pair::{KINDS, Pair};
use crate::contact::surface::placed::{PlacedSurfaces, Way};
use crate::contact::surface::points::Points;
use crate::contact::surface::reach::Reach;
use crate::contact::surface::search::Search;
use crate::parallel::gather::{Spare, gather};
use crate::parallel::workers::Workers;
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// Pairs that may touch while the list holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairList {
    /// Corners and faces, and edges.
    pub pairs: [Vec<Pair>; 2],
    /// The number of these that were there before the last search.
    pub known: [usize; 2],
    life: Option<Life>,
    star_pairs: StarPairSearch,
    spare_pairs: Spare<Vec<Pair>>,
    spare_crossings: Spare<Vec<Crossing>>,
    /// The ways that it expects: from where all points were when it was made to where they are at its end.
    starts: Vec<Vec4>,
    targets: Vec<Vec4>,
}

/// The substeps for which a list holds.
#[derive(Clone, Copy, Debug)]
struct Life {
    /// All of them, and those that have passed.
    substeps: u32,
    age: u32,
    /// Metres that corners may be off the way that it expects.
    slack: f32,
}

impl PairList {
    pub fn clear(&mut self) {
        self.pairs.iter_mut().for_each(Vec::clear);
        self.life = None;
    }

    /// True if there is a list for the present substep.
    pub fn holds(&self) -> bool {
        self.life.is_some_and(|life| life.age < life.substeps)
    }

    /// Lists the pairs that may touch in the next substeps, if parts keep this `distance` at least (metres). Lists
    /// `crossings` as well, if they are given.
    pub fn make(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        substep: Substep,
        distance: f32,
        crossings: Option<&mut Vec<Crossing>>,
        workers: &Workers,
    ) {
        self.clear();
        let substeps = substeps(substep);
        surfaces.sharpen(points);
        surfaces.look_at_all();
        self.expect(&points.start, &points.flight, substeps);
        let slack = SLACK_OF_SURFACES * distance;
        self.star_pairs.has_crossings = crossings.is_some();
        self.search(surfaces, points, bodies, slack, 0.5, substep.isa, workers);
        if let Some(found) = crossings {
            let PlacedSurfaces { rows, stars, .. } = &*surfaces;
            let Self { star_pairs, spare_crossings: spare, .. } = self;
            let pairs = &mut star_pairs.found.crossings;
            gather(pairs, LEAST_SHARED_PAIRS, workers, spare, found, &|pairs, found| {
                substep.isa.run(FindCrossings { rows, stars, pairs, found });
            });
        }
        self.star_pairs.has_crossings = false;
        self.life = Some(Life { substeps, age: 0, slack });
    }

    /// Makes a list at the end of a substep, in which no part was near another when it began: as if all stars were off their
    /// way.
    pub fn make_at_end(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        substep: Substep,
        distance: f32,
        workers: &Workers,
    ) {
        self.clear();
        surfaces.sharpen(points);
        surfaces.look_at_all();
        let substeps = substeps(substep);
        self.search_onwards(surfaces, points, bodies, substeps, distance, substep.isa, workers);
    }

    /// Looks for the pairs of stars that are off their way at the end of a substep; false if there are none.
    pub fn renew(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        distance: f32,
        isa: Isa,
        workers: &Workers,
    ) -> bool {
        let Some(life) = self.life else { return false };
        let fraction = (life.age + 1) as f32 / life.substeps as f32;
        let way = Way { starts: &self.starts, targets: &self.targets, fraction };
        if !surfaces.find_stale(points, way, life.slack) {
            return false;
        }
        self.search_onwards(surfaces, points, bodies, life.substeps - life.age, distance, isa, workers);
        true
    }

    /// Looks for the pairs of stars that are looked at, where all go on for some `substeps` as in this one.
    fn search_onwards(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        substeps: u32,
        distance: f32,
        isa: Isa,
        workers: &Workers,
    ) {
        let slack = SLACK_OF_SURFACES * distance;
        self.expect(&points.start, &points.end, substeps);
        self.search(surfaces, points, bodies, slack, 1.0 / substeps as f32, isa, workers);
        self.life = Some(Life { substeps, age: 0, slack });
    }

    /// Ends a substep.
    pub fn grow_older(&mut self) {
        self.life.iter_mut().for_each(|life| life.age += 1);
    }

    /// Expects that every substep moves each point as far as from `start` to `next`.
    fn expect(&mut self, start: &[Vec4], next: &[Vec4], substeps: u32) {
        let ways = start.iter().zip(next);
        self.starts.clear();
        self.starts.extend_from_slice(start);
        self.targets.clear();
        self.targets.extend(ways.map(|(&start, &next)| start + (next - start) * substeps as f32));
    }

    /// Adds to the list what may touch on the way to the targets, where one of the two is a star that is looked at. Flat is
    /// what is so at both ends and at this part of the way `between`.
    fn search(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        slack: f32,
        between: f32,
        isa: Isa,
        workers: &Workers,
    ) {
        let reach = Reach { factor: 1.0 + CONTACT_MARGIN_OF_SURFACES, slack };
        let Self { pairs, known, star_pairs, spare_pairs: spare, targets, .. } = self;
        surfaces.place_boxes(bodies, points, targets, between, reach, isa, workers);
        surfaces.star_pairs(bodies, isa, workers, star_pairs);
        surfaces.place_rows(bodies, points, targets, &star_pairs.found, isa, workers);
        for (pairs, known) in pairs.iter_mut().zip(&mut *known) {
            pairs.retain(|pair| !surfaces.is_looked_at(pair.stars));
            *known = pairs.len();
        }
        let PlacedSurfaces { rows, stars, .. } = &*surfaces;
        let star_pairs = [&mut star_pairs.found.corners, &mut star_pairs.found.edges];
        for ((kind, star_pairs), pairs) in KINDS.into_iter().zip(star_pairs).zip(pairs) {
            gather(star_pairs, LEAST_SHARED_PAIRS, workers, spare, pairs, &|pairs, found| {
                isa.run(Search { kind, rows, stars, pairs, reach: reach.of_two(), found });
            });
        }
    }
}

/// Substeps for which a list is made in this one.
fn substeps(substep: Substep) -> u32 {
    (substep.count - substep.index).min(MOST_LISTED_SUBSTEPS)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::contact::surface::pair::Kind;
    use crate::contact::surface::testing::{DISTANCE, Numbers, bodies, flying, touching};
    use crate::simd::miri::unless_miri;

    const SUBSTEPS: u32 = 4;

    struct Made {
        bodies: Vec<Body>,
        points: Points,
        surfaces: PlacedSurfaces,
        list: PairList,
    }

    fn made(seed: u32) -> Made {
        let mut numbers = Numbers(seed);
        let bodies = bodies(&mut numbers, 0.02, 0.002);
        let points = flying(&bodies, &mut numbers, 0.01, 0.002);
        made_of(bodies, points)
    }

    fn made_of(bodies: Vec<Body>, points: Points) -> Made {
        let mut surfaces = PlacedSurfaces::default();
        surfaces.fit(&bodies, &points);
        let mut list = PairList::default();
        let substep = Substep { count: SUBSTEPS, duration: 0.002, ..Substep::default() };
        list.make(&mut surfaces, &points, &bodies, substep, DISTANCE, None, &Workers::default());
        Made { bodies, points, surfaces, list }
    }

    /// Both parts by their sorted corners, the one with the lowest first if both are edges.
    fn key(pair: &Pair) -> (bool, Vec<u32>) {
        let (first, second) = pair.ids.split_at(pair.kind.first_corners());
        let [mut first, mut second] = [first.to_vec(), second.to_vec()];
        first.sort_unstable();
        second.sort_unstable();
        let is_edges = pair.kind == Kind::EdgeEdge;
        if is_edges && second < first {
            core::mem::swap(&mut first, &mut second);
        }
        first.extend(second);
        (is_edges, first)
    }

    /// Asserts that the list has all of these pairs; returns how many there are.
    fn assert_listed(made: &Made, pairs: &[Pair]) -> usize {
        let mut listed: Vec<_> = made.list.pairs.iter().flatten().map(key).collect();
        listed.sort_unstable();
        for pair in pairs {
            assert!(listed.binary_search(&key(pair)).is_ok(), "{pair:?} is not listed");
        }
        let count = listed.len();
        listed.dedup();
        assert_eq!(listed.len(), count, "no pair is listed twice");
        pairs.len()
    }

    #[test]
    fn all_that_touches_within_the_slack_of_its_way_is_listed_once() {
        let mut count = 0;
        for seed in 0..unless_miri(40, 1) {
            let made = made(seed);
            let mut numbers = Numbers(seed + 1000);
            for substep in 0..=SUBSTEPS {
                let fraction = substep as f32 / SUBSTEPS as f32;
                let way = Way { starts: &made.list.starts, targets: &made.list.targets, fraction };
                let slack = 0.99 * SLACK_OF_SURFACES * DISTANCE;
                let places: Vec<Vec4> = (0..made.points.start.len() as u32)
                    .map(|id| (way.expected(id) + numbers.vector().normalize_or_zero() * slack).extend(0.0))
                    .collect();
                count += assert_listed(&made, &touching(&made.surfaces, &made.points, &places));
            }
        }
        assert!(count > unless_miri(1000, 10), "{count} pairs touch");
    }

    /// Points that leave their way by more than the slack have their pairs looked for anew: then these are listed as well.
    #[test]
    fn what_leaves_its_way_is_looked_for_anew() {
        // A third of the points jump, or a few.
        let mut count = 0;
        for (seed, every) in (0..unless_miri(40, 1)).flat_map(|seed| [(seed, 3), (seed, 31)]) {
            let mut made = made(seed);
            let mut numbers = Numbers(seed + 2000);
            for end in made.points.end.iter_mut().step_by(every) {
                *end += (numbers.vector() * 0.02).extend(0.0);
            }
            let before = touching(&made.surfaces, &made.points, &made.points.end);
            let Made { bodies, points, surfaces, list } = &mut made;
            assert!(list.renew(surfaces, points, bodies, DISTANCE, Isa::default(), &Workers::default()));
            count += assert_listed(&made, &before);
        }
        assert!(count > unless_miri(200, 5), "{count} pairs touch");
    }

    /// A corner that is to pass over an edge of its own face, in the plane of the cloth, and is off its way by less than the slack:
    /// a list that is made anew for something far away sees the face turn over.
    #[test]
    fn a_face_that_is_to_turn_over_is_looked_for_before_it_has_turned() {
        let mut bodies = bodies(&mut Numbers(6), 0.0, 0.0);
        bodies.truncate(1);
        let mut points = Points::default();
        points.begin_substep(&bodies);
        points.read_starts(&bodies);
        let mut surfaces = PlacedSurfaces::default();
        surfaces.fit(&bodies, &points);
        let stars = || surfaces.stars.iter();
        let faces = || stars().flat_map(|star| (0..star.face_count as usize).map(|k| star.face(k)));
        let shared =
            |face: [u32; 3], other: [u32; 3]| other.into_iter().filter(|id| face.contains(id)).count();
        let first = faces().next().expect("has faces");
        let next = faces().find(|&face| shared(first, face) == 2).expect("has a neighbour");
        let corner = first.into_iter().find(|id| !next.contains(id)).expect("is another");
        let edge = points.starts([0, 1, 2].map(|k| first[k])).into_iter().sum::<Vec3>();
        let [before] = points.starts([corner]);
        let middle = 0.5 * (edge - before);
        let onward = (middle - before).normalize();
        points.start[corner as usize] = (middle - 0.004 * onward).extend(0.0);
        let far = |id: u32| points.starts([id])[0].distance_squared(before);
        let far =
            stars().map(|star| star.centre).max_by(|&a, &b| far(a).total_cmp(&far(b))).expect("has stars");
        (points.flight, points.end) = (points.start.clone(), points.start.clone());

        let mut made = made_of(bodies, points);
        let pair = Pair { ids: [corner, next[0], next[1], next[2]], ..Pair::default() };
        assert!(made.list.pairs.iter().flatten().all(|listed| key(listed) != key(&pair)), "it lies flat");
        let Made { bodies, points, surfaces, list } = &mut made;
        points.end[corner as usize] += (0.9 * SLACK_OF_SURFACES * DISTANCE * onward).extend(0.0);
        points.end[far as usize] += (2.0 * SLACK_OF_SURFACES * DISTANCE * onward).extend(0.0);
        assert!(list.renew(surfaces, points, bodies, DISTANCE, Isa::default(), &Workers::default()));
        assert_listed(&made, &[pair]);
    }

    #[test]
    fn what_keeps_to_its_way_needs_no_new_list() {
        let Made { bodies, points, mut surfaces, mut list } = made(3);
        let workers = Workers::default();
        assert!(!list.renew(&mut surfaces, &points, &bodies, DISTANCE, Isa::default(), &workers));
    }

    #[test]
    fn a_list_holds_for_the_substeps_that_are_left() {
        let Made { mut list, .. } = made(4);
        for _ in 0..SUBSTEPS {
            assert!(list.holds());
            list.grow_older();
        }
        assert!(!list.holds());
    }

    #[test]
    fn bodies_far_apart_make_an_empty_list_that_holds() {
        let mut numbers = Numbers(5);
        let mut bodies = bodies(&mut numbers, 0.02, 0.002);
        for (k, body) in bodies.iter_mut().enumerate() {
            for i in 0..body.particles.len() {
                let place = body.particles.position(i) + Vec3::X * k as f32;
                body.particles.set_position(i, place);
            }
        }
        // Flat, so that no body is near itself.
        let flat = |body: &mut Body| {
            for i in 0..body.particles.len() {
                let place = body.topology.rest[i] + body.particles.position(0);
                body.particles.set_position(i, place);
            }
        };
        bodies.iter_mut().for_each(flat);
        let mut points = Points::default();
        points.begin_substep(&bodies);
        points.read_starts(&bodies);
        points.flight = points.start.clone();
        let list = made_of(bodies, points).list;
        assert!(list.holds());
        assert!(list.pairs.iter().all(Vec::is_empty));
    }
}
