//! The broad phase: searches for the pairs that could touch within a step. `detect` of each kind of contact calls them.
//!
//! Imports: `constraint` and below. Callers: `contact` and `step`.

pub(crate) mod ball_search;
pub(crate) mod ball_search_lanes;
pub(crate) mod cell_list;
pub(crate) mod obstacle_search;
pub(crate) mod relative_motion;
pub(crate) mod surface_pairs;
