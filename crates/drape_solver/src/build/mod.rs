//! Builders: they turn a cloth's size, a rope's length or a mesh into particles and a topology.
//!
//! ```
//! use drape_solver::glam::Vec3;
//! use drape_solver::{BodySettings, ClothBuilder, Edge, Preset, RopeBuilder};
//!
//! let flag = ClothBuilder::new(1.5, 1.0, 31, 21)
//!     .material(Preset::Silk.material())
//!     .pin_edge(Edge::Left)
//!     .build(Preset::Silk.settings(BodySettings::default()))?;
//! assert_eq!(flag.particles.len(), 31 * 21);
//! // Half a kilogram hangs on three metres of rope.
//! let rope = RopeBuilder::new(Vec3::ZERO, Vec3::NEG_Y * 3.0, 40).pin_start().end_mass(0.5);
//! let rope = rope.build(BodySettings::default())?;
//! assert!(rope.particles.is_pinned(0) && rope.particles.inverse_mass(39) <= 2.0);
//! # Ok::<(), drape_solver::BuildError>(())
//! ```
//!
//! Imports: `constraint` and below; no contact and no step. Callers: users, the plugin, and `tearing`.

pub(crate) mod adjacency;
pub(crate) mod bends;
pub mod cloth;
pub mod embedding;
pub(crate) mod measured_fabric;
pub(crate) mod membrane;
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
