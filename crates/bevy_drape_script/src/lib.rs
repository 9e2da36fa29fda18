#![doc = include_str!("../README.md")]

pub mod asset;
mod check;
pub mod checkpoint;
mod container;
mod error;
mod explain;
#[cfg(feature = "harness")]
pub mod harness;
mod hint;
#[cfg(feature = "junit")]
pub mod junit;
mod load;
mod mesh_file;
pub mod overriding;
pub mod play;
pub mod recording;
pub mod report;
pub mod runner;
pub mod scene;
pub mod schema;
mod step_times;
mod suggest;
pub mod suite;
mod text;

pub use error::SceneError;
#[cfg(feature = "junit")]
pub use junit::to_junit;
pub use overriding::Override;
pub use report::Report;
pub use runner::{SCENE_SUFFIX, SceneRunner, run_scene, run_scene_with, scene_name};
pub use scene::SceneScript;
pub use suite::scene_files;
