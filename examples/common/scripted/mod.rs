//! The runner of scripted scenes: a command line, suites, recordings, plots, pictures and windows.
//!
//! Imports `view`. The example `scene` calls it.

pub mod arguments;
#[cfg(feature = "render")]
mod framing;
#[cfg(feature = "render")]
mod materials;
#[cfg(feature = "render")]
mod pictures;
mod plot;
pub mod replay;
#[cfg(feature = "window")]
pub mod replay_window;
#[cfg(feature = "render")]
mod shape_meshes;
pub mod suite;
#[cfg(feature = "window")]
pub mod window;
