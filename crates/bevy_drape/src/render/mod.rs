//! Meshes: bodies shown as meshes, and bodies made from meshes.
//!
//! Imports bodies, descriptions and levels of detail below. The mesh plugin runs these systems; `tear/` must know which of the
//! components a piece does not inherit.

pub(crate) mod any_mesh;
pub(crate) mod build_surfaces;
pub(crate) mod detail_mesh;
pub mod from_mesh;
pub(crate) mod normals;
pub mod plugin;
pub mod rope_mesh;
pub(crate) mod smoothing;
pub(crate) mod surface;
pub(crate) mod torn_mesh;
pub(crate) mod tube;
pub(crate) mod vertex_map;
pub(crate) mod vertices;
pub(crate) mod visibility;
pub(crate) mod write_surfaces;
