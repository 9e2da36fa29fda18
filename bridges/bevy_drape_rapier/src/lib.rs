#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin      the plugin: what is watched, and when in a step
//! changes     the colliders and bodies that changed since the last step
//! obstacles   colliders and dynamic bodies as obstacles
//! motion      reads the motion of dynamic bodies, writes it back, and wakes them
//! world       bodies and colliders in Rapier's sets, by entity
//! ```

mod changes;
mod motion;
mod obstacles;
mod plugin;
mod world;

pub use bevy_drape_bridge::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};
pub use plugin::RapierDrapePlugin;
