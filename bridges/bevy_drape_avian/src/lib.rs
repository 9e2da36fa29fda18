#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin      the plugin: what is watched, and when in a step
//! sleep       sends bodies that lie on cloth to sleep, and wakes them
//! motion      takes the motion of dynamic bodies over, and hands it back
//! obstacles   makes obstacles of the colliders of static and kinematic bodies, and takes them away again
//! bodies      makes one obstacle of all colliders of a dynamic body
//! outdated    the colliders and bodies that changed since the last step
//! frame       the principal axes of a body
//! surface     friction and restitution of a collider
//! marks       marks on colliders, and the ties of bodies to their obstacles
//! ```

mod bodies;
mod frame;
mod marks;
mod motion;
mod obstacles;
mod outdated;
mod plugin;
mod sleep;
mod surface;

pub use marks::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};
pub use plugin::AvianDrapePlugin;
