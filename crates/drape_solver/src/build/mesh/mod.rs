//! mesh.

pub(crate) mod check;
pub mod cloth;
pub mod error;
pub(crate) mod surface;
pub(crate) mod weld;
