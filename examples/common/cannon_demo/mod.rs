//! The cannon demo: a cannon bombards a curtain. Its scene, its report, and the ways to watch it.
//!
//! Imports `view`. The example `cannon` calls it.

pub mod arguments;
#[cfg(feature = "window")]
mod controls;
#[cfg(feature = "render")]
pub mod film;
#[cfg(feature = "render")]
mod frame_capture;
#[cfg(feature = "render")]
mod frames;
pub mod headless;
#[cfg(feature = "render")]
mod materials;
mod output;
#[cfg(feature = "window")]
mod overlay;
#[cfg(all(feature = "web", target_family = "wasm"))]
pub mod page;
mod plot;
pub mod plugin;
pub mod recorder;
pub mod report;
pub mod scene;
pub mod shot;
pub mod soak;
#[cfg(feature = "table1")]
pub mod table1;
#[cfg(feature = "render")]
mod views;
#[cfg(feature = "window")]
pub mod window;
