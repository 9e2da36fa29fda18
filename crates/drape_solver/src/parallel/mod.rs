//! Threads of the host, and the workers that share a large body.
//!
//! Imports: nothing. Callers: `substep` and whoever shares a body.

pub(crate) mod for_each;
pub mod threads;
pub(crate) mod workers;
