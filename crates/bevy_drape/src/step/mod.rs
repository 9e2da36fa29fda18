//! Takes the active bodies and balls through the solver.
//!
//! Groups them into islands, moves their columns into the solver and back. Imports the data below; only the schedule of a step
//! calls these systems.

pub(crate) mod advance;
pub(crate) mod components;
pub(crate) mod compute_threads;
pub(crate) mod form_islands;
pub(crate) mod island_run;
pub(crate) mod islands;
pub mod motion_limits;
pub(crate) mod plugin;
pub(crate) mod run;
