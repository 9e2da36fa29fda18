//! Plays a scene in a Bevy app: spawns it, runs its timeline, evaluates its expectations.
//!
//! ```
//! use bevy_drape_script::play::ScenePlay;
//! use bevy_drape_script::{SceneRunner, SceneScript};
//!
//! let text = r#"(
//!     version: 1,
//!     settings: (duration: 0.5),
//!     bodies: { "ball": Balls(at: (0, 2, 0)) },
//!     expectations: [(probe: Position(of: "ball", axis: Y), expect: AtMost(1))],
//! )"#;
//! let mut runner = SceneRunner::headless(SceneScript::parse(text)?);
//! while runner.step() {}
//! let play = runner.world().resource::<ScenePlay>();
//! assert!(play.is_over() && play.broken().count() == 0);
//! # Ok::<(), bevy_drape_script::SceneError>(())
//! ```
//!
//! Imports `load` for `Set` actions, `checkpoint`, `scene` and `text`. `run` plays scenes step by step; an app with a window
//! adds [`ScenePlugin`] and calls [`begin_scene`].

mod actions;
mod begin;
mod change;
mod command;
mod components;
mod drag;
mod event_counter;
mod expectation_evaluator;
mod measure;
mod messages;
mod named_entity;
mod notes;
mod plugin;
mod points;
mod quantities;
mod resume;
mod scene_entities;
mod scene_play;
mod scheduled_event;
mod simulated_entities;
mod spawn;
mod step;
mod verdict;

pub use begin::{begin_scene, end_scene};
pub use messages::{CheckpointTaken, PictureDue};
pub use plugin::ScenePlugin;
pub use scene_play::ScenePlay;
pub use verdict::Verdict;
