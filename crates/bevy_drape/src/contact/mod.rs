//! Messages about contacts: hits of balls, beginnings and ends of contacts.
//!
//! Reads the contacts that the solver has left in the islands of `step/`. The plugin runs these systems after the substeps.
//!
//! Design: `docs/design/contact_reports.md` and `docs/design/dynamic_obstacles.md`.

pub(crate) mod contact_pairs;
pub mod events;
pub mod hit;
pub(crate) mod plugin;
pub(crate) mod reactions;
pub(crate) mod report_hits;
pub(crate) mod send_contacts;
