#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin      the plugin: what is watched, and when in a step
//! obstacles   makes obstacles of colliders, and takes them away again
//! outdated    the colliders that changed since the last step
//! surface     friction and restitution of a collider
//! marks       marks on colliders
//! ```

mod marks;
mod obstacles;
mod outdated;
mod plugin;
mod surface;

pub use marks::{ColliderObstacle, NoObstacle};
pub use plugin::AvianDrapePlugin;
