#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin      the plugin
//! near        leaves out bodies that nothing of cloth is near
//! load        bodies that cloth carries: when they are still, and when they wake
//! motion      takes the motion of dynamic bodies over, and hands it back
//! collider    makes obstacles of the colliders of static and kinematic bodies, and takes them away again
//! body        makes one obstacle of all colliders of a dynamic body
//! outdated    the colliders and bodies that changed since the last step
//! systems     the order of a step
//! frame       the principal axes of a body
//! marks       marks on colliders, and the ties of bodies to their obstacles
//! ```

mod body;
mod collider;
mod frame;
mod load;
mod marks;
mod motion;
mod near;
mod outdated;
mod plugin;
mod systems;

pub use body::{BodyParts, BodyReach, Part, Parts, reach_of, update_body};
pub use collider::{HasObstacle, obstacle_shape, update_collider};
pub use frame::InertialFrame;
pub use load::{Load, WakeRequest};
pub use marks::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};
pub use motion::{EngineBody, is_any_pushed};
pub use near::Surroundings;
pub use outdated::{Outdated, watch_bodies, watch_colliders, watch_component};
pub use plugin::BridgePlugin;
pub use systems::BridgeSystems;
