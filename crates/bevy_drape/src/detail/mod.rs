//! Level of detail: fewer substeps and particles for bodies far from every viewer.
//!
//! Imports the descriptions and ties below. The plugin runs the system at the start of a step; `render/` swaps meshes to fit.
//!
//! Design: `docs/design/level_of_detail.md`.

pub(crate) mod change;
pub mod level;
pub(crate) mod plugin;
pub(crate) mod resampling;
