//! Builds cloth from triangle meshes: checks, welds and repairs them first.
//!
//! Imports: the builders beside it and the floors below. Callers: users and the plugin.

pub(crate) mod check;
pub mod cloth;
pub mod error;
pub(crate) mod surface;
pub(crate) mod weld;
