//! Pairs that touch, from step to step.

use bevy::prelude::*;

/// Sorted pairs that touch, or touched a moment ago.
#[derive(Resource, Default)]
pub(crate) struct ContactPairs(pub(super) Vec<Pair>);

impl ContactPairs {
    /// All pairs.
    pub fn iter(&self) -> impl Iterator<Item = ((Entity, Entity), ContactPair)> + '_ {
        self.0.iter().map(|pair| (pair.entities, pair.state))
    }

    /// Replaces all pairs.
    pub fn replace(&mut self, pairs: Vec<((Entity, Entity), ContactPair)>) {
        self.0 = pairs.into_iter().map(|(entities, state)| Pair { entities, state }).collect();
        self.0.sort_unstable_by_key(|pair| pair.entities);
    }
}

#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub entities: (Entity, Entity),
    pub state: ContactPair,
}

/// State of a pair that touches, or touched a moment ago.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ContactPair {
    /// Simulated time in seconds of the end of the last step in which they touched.
    pub touched: f64,
    /// Simulated time in seconds at which the contact ends unless they touch again.
    pub until: f64,
    /// True once the start was sent.
    pub is_told: bool,
    /// True from a hit until the impulse falls below half of the threshold.
    pub is_hitting: bool,
}
