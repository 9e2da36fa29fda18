//! Builders: they turn a cloth's size, a rope's length or a mesh into particles and a topology.
//!
//! Imports: `constraint` and below; no contact and no step. Callers: users, the plugin, and `tearing`.

pub(crate) mod adjacency;
pub mod cloth;
pub mod embedding;
pub mod mesh;
pub mod preset;
pub mod ragdoll;
pub mod rigid_tetrahedron;
pub mod rope;
pub mod soft_ball;
pub mod soft_body;
pub mod soft_lattice;
pub(crate) mod topology_builder;
pub(crate) mod weave;
