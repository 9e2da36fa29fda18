//! parallel.

pub(crate) mod for_each;
pub mod threads;
pub(crate) mod workers;
