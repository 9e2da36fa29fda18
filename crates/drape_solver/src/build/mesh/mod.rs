//! Cloth from triangle meshes: checks, repairs, welding, and the cloth itself.
//!
//! Imports: the builders beside it and the floors below. Callers: users and the plugin.

pub(crate) mod check;
pub mod cloth;
pub mod error;
pub(crate) mod surface;
pub(crate) mod weld;
