//! Bodies that are solved and drawn on the GPU, by the crate `drape_gpu` on the device of Bevy's renderer.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_drape::gpu::SolveOnGpu;
//! use bevy_drape::prelude::*;
//!
//! fn raise_flags(mut commands: Commands) {
//!     for i in 0..10_000 {
//!         let place = Transform::from_xyz((i % 100) as f32 * 2.0, 5.0, (i / 100) as f32 * 2.0);
//!         commands.spawn((Cloth::new(1.5, 1.0).with_pins(ClothPins::Left), SolveOnGpu, place));
//!     }
//! }
//! ```
//!
//! ```text
//!   processor   ManageScene:          FormIslands:                PostUpdate:
//!                 move_to_gpu           wake_on_gpu                 take_report                    move_tubes
//!                 choose_detail_on_gpu  step_on_gpu                 write_bounds                   list_shown
//!                 move_pins_on_gpu                 |                          ^                            |
//!                     |                            |                          |                            |
//!   GPU         +-----v----------------------------v--------------------------|----+   last step   +-------v--------------+
//!               |  GpuWorld: particles, sticks, obstacles, pins, wind, statuses    | ------------> |  vertices of meshes  | -> all passes
//!               +------------------------------------------------------------------+  write_slabs  +----------------------+
//! ```
//!
//! Imports the body's components, `attach`, `build`, `detail`, the environment, viewers, `sleep`, the step's systems and `render`; nothing but the
//! plugin group imports this.

mod bodies;
mod components;
mod detail;
mod moves;
mod pins;
mod plugin;
mod renderer;
pub(crate) mod report;
mod rest;
mod shown;
mod step;

pub use bodies::GpuBodies;
pub use components::{GpuBody, SolveOnGpu};
pub use drape_gpu;
pub use plugin::GpuPlugin;
