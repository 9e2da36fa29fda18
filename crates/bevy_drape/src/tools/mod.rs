//! Tools for players and developers: picking, gestures, spatial queries, gizmos, diagnostics.
//!
//! Imports any floor below; nothing below knows of them.
//!
//! Design: `docs/design/interaction.md`.

mod body_hit;
pub mod diagnostics;
pub mod gestures;
#[cfg(feature = "gizmos")]
pub mod gizmos;
#[cfg(feature = "gizmos")]
mod obstacle_gizmos;
#[cfg(feature = "picking")]
pub mod picking;
mod point_projection;
mod query_filter;
pub mod ray_cast;
pub mod spatial_query;
mod sphere_cast;
