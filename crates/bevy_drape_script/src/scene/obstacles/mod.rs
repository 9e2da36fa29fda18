//! Obstacles: their shapes and motions.
//!
//! Import `value`. Called by `scene_script`, the checks and `play`.

mod motion;
mod obstacle;
mod shape;

pub use motion::{Dynamic, Keyframe, Keyframes, Motion, Steady};
pub use obstacle::Obstacle;
pub use shape::{Part, Shape};
