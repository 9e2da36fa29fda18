//! A substep's order for one body, and the ways to walk it: stage by stage, or in sweeps down its strips on several threads.
//!
//! Imports: contacts, constraints and below. Callers: `step`.

pub(crate) mod begin;
pub(crate) mod island_bodies;
pub(crate) mod order;
pub(crate) mod plan;
pub(crate) mod sweep;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod work;
