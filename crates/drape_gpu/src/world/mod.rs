//! Bodies on the GPU, stepped together.
//!
//! [`GpuWorld`] is in `gpu_world.rs`, with the step; `tables.rs` writes what the shaders read of bodies, `dispatches.rs` lists the dispatches of large ones,
//! `read_back.rs` and `statuses.rs` read results, `last_step.rs` is what a renderer is given, and `welded.rs` and `tube.rs` what it knows of meshes. Imports buffers, kernels and models; called by whoever has bodies for the GPU, and by `surface_writer`.

mod body_record;
mod dispatches;
mod gpu_world;
mod last_step;
mod read_back;
mod statuses;
mod tables;
mod tube;
mod welded;

pub(crate) use body_record::BodyPlace;
pub use body_record::GpuBodyId;
pub use gpu_world::GpuWorld;
pub use last_step::LastStep;
pub(crate) use last_step::Places;
pub use read_back::PendingPositions;
pub use statuses::{BodyStatus, PendingStatuses};
pub use tube::{TubeId, TubeVertices};
pub use welded::{WeldedId, WeldedVertices};
