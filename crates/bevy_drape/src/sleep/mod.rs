//! Sleeping, waking and culling.
//!
//! Imports bodies, balls and the environment. The plugin runs these systems before the islands are formed and after they have
//! been stepped.

pub mod activity_counts;
pub(crate) mod candidates;
pub(crate) mod cull;
pub(crate) mod fall_asleep;
pub(crate) mod plugin;
pub mod scene_manager;
pub(crate) mod waking;
