//! Cannon balls and the cannons that fire them.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn setup(mut commands: Commands) {
//!     // Cloth, obstacles and other balls stop it; `Interpolated` draws it between two steps.
//!     let ball = Projectile { radius: 0.15, mass: 2.0, velocity: Vec3::NEG_Z * 10.0, ..default() };
//!     commands.spawn((ball, Interpolated, Transform::from_xyz(0.0, 1.5, 5.0)));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```
//!
//! Imports `environment/` and `body/`. `step/` moves the balls; `contact/` reports their hits.

pub mod cannon;
pub(crate) mod plugin;
pub(crate) mod projectile;

pub use projectile::{Projectile, ProjectileState};
