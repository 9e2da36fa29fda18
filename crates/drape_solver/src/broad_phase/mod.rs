//! The broad phase: searches for the pairs that could touch within a step.
//!
//! Once a step, `detect` of `contact/body_contacts.rs` calls `obstacle_search.rs`, and that of `contact/ball_cloth.rs` calls
//! `ball_search.rs`. Self-contact lists its pairs in the substeps, as often as the motion demands: `contact/surface` by
//! `surface_pairs.rs`.
//!
//! Imports: `constraint` and below. Callers: `contact` and `step`.

pub(crate) mod ball_search;
pub(crate) mod ball_search_lanes;
pub(crate) mod obstacle_search;
pub(crate) mod surface_pairs;
pub(crate) mod swept_box;
