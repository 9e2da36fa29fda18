//! Threads of the host, and the workers that share a large body.
//!
//! Imports: nothing. Callers: `substep` and whoever shares a body.

pub mod threads;
pub(crate) mod workers;
