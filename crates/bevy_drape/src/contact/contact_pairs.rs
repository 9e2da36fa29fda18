//! Pairs that touch, from step to step.

use bevy::prelude::*;

/// Pairs that touch or have just done so, in order.
#[derive(Resource, Default)]
pub(crate) struct ContactPairs(pub(super) Vec<Pair>);

impl ContactPairs {
    /// All pairs.
    pub fn iter(&self) -> impl Iterator<Item = ((Entity, Entity), ContactPair)> + '_ {
        self.0.iter().map(|pair| (pair.entities, pair.state))
    }

    /// Knows these instead of all others.
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

/// What is known of two that touch or have just done so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ContactPair {
    /// Simulated time in seconds of the end of the last step in which they touched.
    pub touched: f64,
    /// Until when the contact lasts.
    pub until: f64,
    /// Whether its start was sent.
    pub is_told: bool,
    /// Whether the impulse has not fallen since the last hit.
    pub is_hitting: bool,
}
