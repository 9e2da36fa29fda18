#![doc = include_str!("../README.md")]

mod check;
mod error;
mod load;
pub mod overriding;
pub mod play;
pub mod recording;
pub mod report;
pub mod runner;
pub mod scene;
mod step_times;
mod text;

pub use error::SceneError;
pub use overriding::Override;
pub use report::Report;
pub use runner::{SCENE_SUFFIX, SceneRunner, run_scene, run_scene_with, scene_name};
pub use scene::SceneScript;
