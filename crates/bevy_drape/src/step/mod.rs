//! Takes the active bodies and balls through the solver.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::step::MotionLimitCounts;
//!
//! fn warn(counts: Res<MotionLimitCounts>) {
//!     // Particles whose painted limit lies inside an obstacle in the last step: the limit holds.
//!     if counts.conflicts > 0 {
//!         println!("{} particles are held inside obstacles", counts.conflicts);
//!     }
//! }
//! # App::new().init_resource::<MotionLimitCounts>().add_systems(Update, warn).update();
//! ```
//!
//! `form_islands.rs` groups them into islands. `island_run.rs` makes the solver's `Body` of the components and moves it back
//! (`take`, `give_back`). `advance.rs` has the systems, `run.rs` runs the schedule.
//!
//! Imports the data below; only the schedule of a step calls these systems.
//!
//! Design: `docs/design/schedule.md` and `docs/design/rest_and_islands.md`.

pub(crate) mod advance;
pub(crate) mod components;
pub(crate) mod compute_threads;
pub(crate) mod form_islands;
pub(crate) mod island_run;
pub(crate) mod islands;
pub(crate) mod motion_limits;
pub(crate) mod plugin;
pub(crate) mod run;

pub use motion_limits::MotionLimitCounts;
