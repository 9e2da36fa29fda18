//! Threads of the host, and the workers that share a large body.
//!
//! Imports: nothing. Callers: every floor that shares a body between threads.

pub(crate) mod for_each;
pub(crate) mod gather;
#[cfg(test)]
pub(crate) mod testing;
pub mod threads;
pub(crate) mod workers;
