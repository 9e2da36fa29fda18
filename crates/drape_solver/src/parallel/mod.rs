//! parallel.

pub mod threads;
pub(crate) mod workers;
