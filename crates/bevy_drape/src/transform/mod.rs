//! Transforms between frames and fixed steps: interpolation, and propagation within the fixed loop.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn setup(mut commands: Commands) {
//!     // Steps are fixed, frames are not: this ball is drawn between its last two steps.
//!     commands.spawn((Projectile::default(), Interpolated, Transform::from_xyz(0.0, 2.0, 0.0)));
//!     // A platform that a system of `Update` moves once a frame: each step sees it on its way.
//!     commands.spawn((Obstacle::cuboid(2.0, 0.1, 2.0), bevy_drape::transform::MovedByFrame));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```
//!
//! Imports `step/` for its order only. Balls, and anything else that moves, may use it.
//!
//! Design: `docs/design/schedule.md` and `docs/design/characters.md`.

pub(crate) mod interpolation;
pub(crate) mod moved_by_frame;
pub(crate) mod plugin;
pub(crate) mod propagation;

pub use interpolation::{Interpolated, InterpolationPlugin};
pub use moved_by_frame::{MovedByFrame, MovedByFramePlugin};
