//! constraint.

pub(crate) mod angular_momentum;
pub mod direct;
pub(crate) mod listed_stick;
pub mod motion_limit;
pub mod stick;
pub(crate) mod strain;
pub mod tether;
pub(crate) mod tether_crossing;
pub mod volume;
