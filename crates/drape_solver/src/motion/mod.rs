//! motion.

pub mod ballistics;
pub mod force;
pub mod frame_motion;
pub(crate) mod integrate;
pub(crate) mod rest;
pub mod wind;
