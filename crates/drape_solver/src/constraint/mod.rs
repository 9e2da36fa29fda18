//! Constraints of a body on itself: sticks, lines of sticks, tethers, volume, limits on motion and backstops.
//!
//! The formula of a stick's error is in `projection.rs`. `stick.rs`, `listed_stick.rs` and `direct/` move the ends of grid
//! sticks, listed sticks and lines; `tether.rs` pulls particles back to their pins.
//!
//! ```
//! use drape_solver::constraint::stick::iteration_stiffness;
//!
//! // A stick of stiffness 0.7 loses 0.7 of its strain in a step of a sixtieth of a second, in however many iterations.
//! for iterations in [1, 5, 20] {
//!     let lost_each_time = iteration_stiffness(0.7, 1.0 / 60.0, iterations);
//!     let strain_left = (1.0 - lost_each_time).powi(iterations as i32);
//!     assert!((strain_left - 0.3).abs() < 1e-5);
//! }
//! ```
//!
//! Imports: `motion` and below. Callers: `substep`, `step` and the builders.

pub(crate) mod angular_momentum;
pub mod backstop;
pub(crate) mod bend;
pub(crate) mod bending_friction;
pub(crate) mod damping;
pub mod direct;
pub(crate) mod listed_bend;
pub(crate) mod listed_damping;
pub(crate) mod listed_stick;
pub mod motion_limit;
pub(crate) mod projection;
pub mod stick;
pub(crate) mod strain;
#[cfg(test)]
pub(crate) mod testing;
pub mod tether;
pub mod volume;
