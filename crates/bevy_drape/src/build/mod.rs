//! Descriptions of bodies (cloth, rope, soft ball, rigid tetrahedron) and the systems that build bodies from them.
//!
//! Imports `body/`. The plugin runs the systems at the start of a step; `render/` and `tear/` look at the descriptions.

pub mod cloth;
pub(crate) mod description;
pub(crate) mod plugin;
pub mod preset;
pub mod rigid_tetrahedron;
pub mod rope;
pub mod soft_ball;
