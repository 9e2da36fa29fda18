//! Sleeping, waking and culling, by the rules of the solver's `world/activity_rules.rs` and `world/waking.rs`.
//!
//! `waking.rs`, `cull.rs` and `fall_asleep.rs` have one system each. `candidates.rs` lists the bodies that they check.
//!
//! Imports bodies, balls and the environment. The plugin runs these systems before the islands are formed and after they have
//! been stepped.
//!
//! Design: `docs/design/rest_and_islands.md`.

pub mod activity_counts;
pub(crate) mod candidates;
pub(crate) mod cull;
pub(crate) mod fall_asleep;
pub(crate) mod plugin;
pub mod scene_manager;
pub(crate) mod waking;
