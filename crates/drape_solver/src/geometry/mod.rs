//! Shapes, poses, and the nearest points, distances and sweeps between them.
//!
//! ```
//! use drape_solver::Shape;
//! use drape_solver::glam::Vec3;
//! use drape_solver::parry3d::shape::SharedShape;
//!
//! let cone = Shape::from_parry(SharedShape::cone(0.5, 0.3))?;
//! // Its tip is half a metre above its middle.
//! assert!((cone.distance(Vec3::Y * 2.0) - 1.5).abs() < 1e-4);
//! let (low, high) = cone.local_bounds();
//! assert!((high - low - Vec3::new(0.6, 1.0, 0.6)).length() < 1e-4);
//! # Ok::<(), drape_solver::BuildError>(())
//! ```
//!
//! Imports: `simd` and the ground. Callers: everything above.

pub(crate) mod approach;
pub mod compound;
pub(crate) mod lane_boxes;
pub mod mesh;
pub(crate) mod nearest;
pub(crate) mod nearest_lanes;
pub(crate) mod nearest_segments;
pub mod nearest_triangle;
pub(crate) mod parry_surface;
pub(crate) mod pose;
pub mod shape;
pub(crate) mod surface_lanes;
pub(crate) mod sweep;
pub(crate) mod taper;
