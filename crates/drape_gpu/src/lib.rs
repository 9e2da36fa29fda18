#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! ```text
//! world          bodies on the GPU, stepped together: start here
//! passes         the dispatches of large bodies in one step, in order
//! buffers        the buffers of a world, and the bind groups made of them
//! kernels        the compute pipelines, and what they bind
//! model          the rest data of bodies, as the shaders read it
//! obstacle       obstacles, as the shaders read them
//! air            gravity and wind of a step, as the shaders read them
//! timer          times a step on the GPU's own clock
//! growing_buffer a buffer on the GPU that grows
//! gpu            a device with compute shaders
//! layout         what the shaders read, field by field
//! error          typed errors
//! ```

mod air;
mod buffers;
mod error;
mod gpu;
mod growing_buffer;
mod kernels;
mod layout;
mod model;
mod obstacle;
mod passes;
mod timer;
mod world;

pub use error::GpuError;
pub use gpu::Gpu;
pub use obstacle::MAX_OBSTACLES;
pub use world::{BodyStatus, GpuBodyId, GpuWorld};

pub use drape_solver;
pub use wgpu;
