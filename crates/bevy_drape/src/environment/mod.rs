//! Obstacles, gravity and wind: everything that the solver's `Environment` holds.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn setup(mut commands: Commands) {
//!     commands.insert_resource(DrapeGravity(Vec3::NEG_Y * 1.62)); // on the moon
//!     commands.spawn((Obstacle::ground().with_friction(0.8), Transform::default()));
//!     commands.spawn((Obstacle::sphere(0.5), Transform::from_xyz(0.0, 1.0, 0.0)));
//!     // A crate that cloth pushes back.
//!     let crate_ = DynamicObstacle::cuboid(2.0, Vec3::splat(0.3));
//!     commands.spawn((Obstacle::cuboid(0.3, 0.3, 0.3), crate_, Transform::from_xyz(2.0, 1.0, 0.0)));
//!     commands.spawn((WindZone::default(), Transform::from_xyz(-1.5, 1.0, 0.0)));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```
//!
//! Imports `body/`. The plugin brings the components into the environment at the start of a step; `step/` hands the
//! environment to the solver.
//!
//! Design: `docs/design/wind.md`, `docs/design/dynamic_obstacles.md` and `docs/design/broad_phase.md`.

pub(crate) mod dynamic_obstacle;
pub(crate) mod fly_obstacles;
pub(crate) mod gravity;
pub(crate) mod known_obstacles;
pub(crate) mod moved_by_obstacle;
pub(crate) mod obstacle;
pub(crate) mod obstacle_changes;
pub(crate) mod obstacle_shape;
pub(crate) mod plugin;
pub(crate) mod solver_environment;
pub(crate) mod sync_obstacles;
pub(crate) mod wake_regions;
pub(crate) mod wind;
pub(crate) mod wind_zone;

pub use dynamic_obstacle::{DynamicObstacle, ObstacleReaction, PlannedPlacement};
pub use gravity::DrapeGravity;
pub use moved_by_obstacle::MovedByObstacle;
pub use obstacle::{CombineRule, Obstacle, TeleportObstacle};
pub use obstacle_shape::{CustomShape, ObstacleShape, ShapeFromMesh};
pub use wind::{Gusts, Wind};
pub use wind_zone::{WindFlow, WindRegion, WindZone};
