//! Feature-based: a closest-feature query for each candidate pair.
//!
//! Without a spatial structure: in a step whose balls come near the cloth, the boxes of all faces are compared with the
//! space that a ball can reach, which gives the step's candidates. In a substep each candidate whose box touches the
//! ball's is queried for its closest feature. Walking from feature to feature of the substep before, as Lin and Canny
//! (1991) do for convex bodies, does not apply: a cloth is not convex, and needs all contacts, not one.

use drape_solver::glam::Vec3A;

use super::closest_feature::ClosestFeatureQueries;
use super::method::{Contact, Method, Pair};
use super::state::State;

/// See the [module](self).
#[derive(Default)]
pub struct FeatureBased {
    /// Candidates of the step: ball and face.
    candidates: Vec<Pair>,
    queries: ClosestFeatureQueries,
}

impl Method for FeatureBased {
    fn name(&self) -> &'static str {
        "feature-based"
    }

    fn begin_step(&mut self, state: &mut State) {
        self.candidates.clear();
        for (ball, sphere) in state.near_balls() {
            let reach = sphere.reach + state.motion;
            let centre = Vec3A::from(sphere.centre);
            let (low, high) = (centre - reach, centre + reach);
            let faces = 0..state.faces.len() as u32;
            self.candidates
                .extend(faces.filter(|&face| state.is_within(face, low, high)).map(|face| (ball, face)));
        }
    }

    fn find(&mut self, state: &mut State) -> usize {
        self.queries.clear();
        for &(ball, face) in &self.candidates {
            self.queries.query(state, ball, &state.balls[ball as usize], face);
        }
        self.queries.count
    }

    fn pairs(&self, _: &State) -> Vec<Pair> {
        self.queries.contacts.iter().map(|contact: &Contact| contact.pair).collect()
    }
}
