#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! Each folder of `src` is a floor, which imports only from floors below:
//!
//! ```text
//! run/          runs scenes without a window: runner, suites, test harness, reports, assets
//! play/         plays a scene in an app: spawns it, runs its timeline, evaluates its expectations
//! load/         loads scenes from files: fragments, overrides, checks
//! recording/    records positions step by step, to the last bit, and compares recordings
//! checkpoint    the state of a running world in a file
//! container     the binary container of recordings and checkpoints
//! scene/        the scene file format as types
//! mesh/         triangle meshes, read from glTF files or generated
//! text/         the text of scene files: paths, positions, explained errors
//! ```

pub mod checkpoint;
mod container;
mod load;
mod mesh;
pub mod play;
pub mod recording;
mod run;
pub mod scene;
mod text;

pub use load::Override;
pub use run::*;
pub use scene::SceneScript;
pub use text::SceneError;
