#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin      the plugin: what is watched, and when in a step
//! sleep       sends bodies that lie on cloth to sleep, and wakes them
//! changes     the colliders and bodies that changed since the last step
//! obstacles   colliders and dynamic bodies as obstacles
//! motion      reads the motion of dynamic bodies, and writes it back
//! surface     friction and restitution of a collider
//! ```

mod changes;
mod motion;
mod obstacles;
mod plugin;
mod sleep;
mod surface;

pub use bevy_drape_bridge::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};
pub use plugin::AvianDrapePlugin;
