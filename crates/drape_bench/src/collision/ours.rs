//! Ours: the solver's own detection, called as the step calls it.
//!
//! Broad phase: [`detect_collisions`] lists the faces with a corner that can come near a ball within the step. Narrow
//! phase: [`Island::ball_cloth_contacts`](drape_solver::Island::ball_cloth_contacts) goes through the list as the
//! projection of contacts does. Unlike the other methods it also gives the side of the face on which the ball began the
//! substep, so that a fast ball is not pushed out on the wrong side.

use std::collections::HashMap;

use drape_solver::BallClothContact;
use drape_solver::step::detect_collisions;

use super::method::{Method, Pair};
use super::state::State;

/// See the [module](self).
#[derive(Default)]
pub struct Ours {
    found: Vec<BallClothContact>,
}

impl Method for Ours {
    fn name(&self) -> &'static str {
        "ours"
    }

    fn begin_step(&mut self, state: &mut State) {
        detect_collisions(&mut state.island, &state.environment);
    }

    fn find(&mut self, state: &mut State) -> usize {
        self.found.clear();
        state.island.ball_cloth_contacts(&mut self.found)
    }

    fn pairs(&self, state: &State) -> Vec<Pair> {
        let faces: HashMap<_, _> = state.faces.iter().copied().zip(0..).collect();
        let pair = |contact: &BallClothContact| {
            let corners = contact.particles(state.cloth()).map(|particle| particle as u32);
            faces.get(&corners).map(|&face| (contact.ball as u32, face))
        };
        self.found.iter().filter_map(pair).collect()
    }
}
