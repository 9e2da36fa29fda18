#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin      the plugin: what is watched, and when in a step
//! obstacles   colliders as obstacles
//! changes     the colliders that changed since the last step
//! prism       shapes of two dimensions as solids
//! surface     friction and restitution of a collider
//! ```

mod changes;
mod obstacles;
mod plugin;
mod prism;
mod surface;

pub use bevy_drape_bridge::{ColliderObstacle, NoObstacle};
pub use plugin::Avian2dDrapePlugin;
