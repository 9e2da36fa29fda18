//! Constraints of a body on itself: sticks, lines of sticks, tethers, volume and limits on motion.
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
