//! The broad phase lists the pairs that could touch within a step.
//!
//! Imports: `constraint` and below. Callers: `contact` and `step`.

pub(crate) mod ball_search;
pub(crate) mod ball_search_lanes;
pub(crate) mod cell_list;
pub(crate) mod obstacle_search;
pub(crate) mod relative_motion;
pub(crate) mod surface_pairs;
