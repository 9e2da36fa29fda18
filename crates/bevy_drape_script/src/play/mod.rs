//! Plays a scene in a Bevy app: spawns it, runs its timeline, evaluates its expectations.
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
