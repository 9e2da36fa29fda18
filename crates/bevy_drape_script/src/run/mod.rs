//! Runs scenes without a window: the runner, suites of files, the test harness, reports, Bevy assets.
//!
//! Imports all other floors. Tests, benchmarks and the command line of the examples call it.

pub mod asset;
#[cfg(feature = "harness")]
pub mod harness;
#[cfg(feature = "junit")]
mod junit;
mod report;
mod runner;
mod scene_files;
mod step_times;

#[cfg(feature = "junit")]
pub use junit::to_junit;
pub use report::Report;
pub use runner::{SceneRunner, run_scene, run_scene_with};
pub use scene_files::{SCENE_SUFFIX, scene_files, scene_name};
