//! Messages about contacts: hits of balls, begin and end of contacts.
//!
//! Reads the contacts that the solver has left in the islands of `step/`. The plugin runs these systems after the substeps.

pub mod events;
pub mod hit;
