#![cfg_attr(feature = "wgpu", doc = include_str!("../README.md"))]
#![cfg_attr(
    not(feature = "wgpu"),
    doc = "Cloth on the GPU. Nothing is compiled without a backend: choose the feature `native`, or one of its parts."
)]
//!
//! # Floors
//!
//! ```text
//! surface_writer positions and normals of bodies in a buffer of vertices
//! world/         bodies on the GPU, stepped together: start here
//! buffers        the buffers of a world, and the bind groups made of them
//! kernels        the compute pipelines, and what they bind
//! model          the rest data of bodies, as the shaders read it
//! obstacle       obstacles, as the shaders read them
//! distance_field signed distances of shapes without a formula, sampled once on a lattice
//! air            gravity and wind of a step, as the shaders read them
//! snapshots      positions before and after the last step
//! timer          times a step on the GPU's own clock
//! growing_buffer a buffer on the GPU that grows
//! gpu            a device with compute shaders
//! source         the sources of the shaders
//! layout         structures for the shaders, field by field
//! error          typed errors
//! ```

#[cfg(feature = "wgpu")]
mod air;
#[cfg(feature = "wgpu")]
mod buffers;
#[cfg(feature = "wgpu")]
mod distance_field;
#[cfg(feature = "wgpu")]
mod error;
#[cfg(feature = "wgpu")]
mod gpu;
#[cfg(feature = "wgpu")]
mod growing_buffer;
#[cfg(feature = "wgpu")]
mod kernels;
#[cfg(feature = "wgpu")]
mod layout;
#[cfg(feature = "wgpu")]
mod model;
#[cfg(feature = "wgpu")]
mod obstacle;
#[cfg(feature = "wgpu")]
mod snapshots;
// Its tests need no backend.
#[cfg(any(test, feature = "wgpu"))]
mod source;
#[cfg(feature = "wgpu")]
mod surface_writer;
#[cfg(feature = "wgpu")]
mod timer;
#[cfg(feature = "wgpu")]
mod world;

#[cfg(feature = "wgpu")]
pub use error::GpuError;
#[cfg(feature = "wgpu")]
pub use gpu::Gpu;
#[cfg(feature = "wgpu")]
pub use source::MAX_OBSTACLES;
#[cfg(feature = "wgpu")]
pub use surface_writer::{BodyMesh, BodyVertices, SurfaceWriter};
#[cfg(feature = "wgpu")]
pub use world::{
    BodyStatus, GpuBodyId, GpuWorld, LastStep, PendingPositions, PendingStatuses, TubeId, TubeVertices,
    WeldedId, WeldedVertices,
};

pub use drape_solver;
#[cfg(feature = "wgpu")]
pub use wgpu;
