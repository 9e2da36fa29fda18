//! The list of pairs that may touch: made when a step begins, and renewed star by star.
//!
//! The list expects each corner to fly freely for the rest of the step. As long as all are within a slack of that way, a
//! pair that is not listed cannot touch. At the end of a substep the pairs of stars that have left it are looked for anew.
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

use crate::broad_phase::surface_pairs::StarPairs;
use crate::constants::{CONTACT_MARGIN_OF_SURFACES, SLACK_OF_SURFACES};
use crate::contact::surface::crossing::{Crossing, FindCrossings};
use crate::contact::surface::pair::Pair;
use crate::contact::surface::placed::{PlacedSurfaces, Way};
use crate::contact::surface::points::Points;
use crate::contact::surface::reach::Reach;
use crate::contact::surface::search::Search;
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
    star_pairs: StarPairs,
    /// The ways that it expects: from where all points were when it was made to where they are at its end.
    starts: Vec<Vec4>,
    targets: Vec<Vec4>,
}

/// How long a list holds.
#[derive(Clone, Copy, Debug)]
struct Life {
    /// Substeps for which it was made, and those that have passed.
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

    /// Lists the pairs that may touch in all substeps that are left, if parts keep this `distance` at least (metres). Lists
    /// `crossings` as well, if they are given.
    pub fn make(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        substep: Substep,
        distance: f32,
        crossings: Option<&mut Vec<Crossing>>,
    ) {
        self.clear();
        let substeps = substep.count - substep.index;
        surfaces.look_at_all();
        self.fly_on(points, substeps);
        let mut far = self.reach(FAR * distance);
        far.factor = 1.0;
        surfaces.place(bodies, points, &self.targets, 0.5, far, substep.isa);
        surfaces.star_pairs(bodies, substep.isa, &mut self.star_pairs);
        if self.star_pairs.is_empty() {
            self.life = Some(Life { substeps, age: 0, slack: far.slack });
            return;
        }
        let slack = SLACK_OF_SURFACES * distance;
        self.star_pairs.has_crossings = crossings.is_some();
        self.search(surfaces, points, bodies, slack, 0.5, substep.isa);
        if let Some(found) = crossings {
            let PlacedSurfaces { rows, stars, .. } = &*surfaces;
            substep.isa.run(FindCrossings { rows, stars, pairs: &self.star_pairs.crossings, found });
        }
        self.star_pairs.has_crossings = false;
        self.life = Some(Life { substeps, age: 0, slack });
    }

    /// Looks for the pairs of stars that are off their way at the end of a substep; false if there are none.
    pub fn renew(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        distance: f32,
        isa: Isa,
    ) -> bool {
        let Some(life) = self.life else { return false };
        let fraction = (life.age + 1) as f32 / life.substeps as f32;
        let way = Way { starts: &self.starts, targets: &self.targets, fraction };
        if !surfaces.find_stale(bodies, points, way, life.slack) {
            return false;
        }
        let substeps = life.substeps - life.age;
        let slack = SLACK_OF_SURFACES * distance;
        if life.slack > slack {
            surfaces.look_at_all();
        }
        self.go_on(points, substeps);
        self.search(surfaces, points, bodies, slack, 1.0 / substeps as f32, isa);
        self.life = Some(Life { substeps, age: 0, slack });
        true
    }

    /// Ends a substep.
    pub fn grow_older(&mut self) {
        self.life.iter_mut().for_each(|life| life.age += 1);
    }

    /// Expects free flight.
    fn fly_on(&mut self, points: &Points, substeps: u32) {
        let ways = points.start.iter().zip(&points.flight);
        self.starts.clone_from(&points.start);
        self.targets.clear();
        self.targets.extend(ways.map(|(&start, &flight)| start + (flight - start) * substeps as f32));
    }

    /// Expects the same at the end of a substep: all go on as in this one.
    fn go_on(&mut self, points: &Points, substeps: u32) {
        let ways = points.start.iter().zip(&points.end);
        self.starts.clone_from(&points.start);
        self.targets.clear();
        self.targets.extend(ways.map(|(&start, &end)| start + (end - start) * substeps as f32));
    }

    fn reach(&self, slack: f32) -> Reach {
        Reach { factor: 1.0 + CONTACT_MARGIN_OF_SURFACES, slack }
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
    ) {
        let reach = self.reach(slack);
        let Self { pairs, known, star_pairs, targets, .. } = self;
        surfaces.place(bodies, points, targets, between, reach, isa);
        surfaces.star_pairs(bodies, isa, star_pairs);
        for (pairs, known) in pairs.iter_mut().zip(known) {
            pairs.retain(|pair| !surfaces.is_looked_at(pair.stars));
            *known = pairs.len();
        }
        let PlacedSurfaces { rows, stars, .. } = &*surfaces;
        isa.run(Search { rows, stars, pairs: star_pairs, reach: reach.of_two(), found: pairs });
    }
}

/// Slack of a list in which nothing is near, in distances that parts keep.
const FAR: f32 = 2.0;
