//! broad_phase.

pub(crate) mod ball_search;
pub(crate) mod ball_search_lanes;
pub(crate) mod cell_list;
pub(crate) mod obstacle_search;
pub(crate) mod relative_motion;
pub(crate) mod surface_tree;
