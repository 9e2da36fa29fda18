//! Constraints of a body on itself: sticks, lines of sticks, tethers, volume and limits on motion.
//!
//! The formula of a stick's error is in `projection.rs`. `stick.rs`, `listed_stick.rs` and `direct/` move the ends of grid
//! sticks, listed sticks and lines; `tether.rs` pulls particles back to their pins.
//!
//! Imports: `motion` and below. Callers: `substep`, `step` and the builders.

pub(crate) mod angular_momentum;
pub mod direct;
pub(crate) mod listed_stick;
pub mod motion_limit;
pub(crate) mod projection;
pub mod stick;
pub(crate) mod strain;
pub mod tether;
pub mod volume;
