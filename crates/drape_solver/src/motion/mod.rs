//! Free motion: forces, wind, the Verlet step, moving frames, and time at rest.
//!
//! `force.rs` has the forces, that of the wind too; `integrate.rs` the Verlet step; `rest.rs` the time at rest.
//!
//! Imports: `state` and below. Callers: `substep` and `step`.

pub mod ballistics;
pub(crate) mod body_columns;
pub mod environment;
pub mod force;
pub(crate) mod integrate;
pub(crate) mod moving_frame;
pub(crate) mod particle_stats;
pub(crate) mod rest;
pub mod wind;
