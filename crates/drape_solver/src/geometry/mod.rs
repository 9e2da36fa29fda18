//! Shapes, poses, and the nearest points, distances and sweeps between them.
//!
//! Imports: `simd` and the ground. Callers: everything above.

pub mod compound;
pub mod mesh;
pub(crate) mod nearest;
pub(crate) mod nearest_lanes;
pub(crate) mod nearest_segments;
pub(crate) mod nearest_triangle;
pub(crate) mod pose;
pub mod shape;
pub(crate) mod surface_lanes;
pub(crate) mod sweep;
