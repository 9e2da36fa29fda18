//! Cannon balls and the cannons that fire them.
//!
//! Imports `environment/` and `body/`. `step/` moves the balls; `contact/` reports their hits.

pub mod cannon;
pub(crate) mod plugin;
pub mod projectile;
