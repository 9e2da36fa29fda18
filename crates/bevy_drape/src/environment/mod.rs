//! Obstacles, gravity and wind: everything that the solver's `Environment` holds.
//!
//! Imports `body/`. The plugin brings the components into the environment at the start of a step; `step/` hands the
//! environment to the solver.
//!
//! Design: `docs/design/wind.md`, `docs/design/dynamic_obstacles.md` and `docs/design/broad_phase.md`.

pub mod dynamic_obstacle;
pub(crate) mod fly_obstacles;
pub mod gravity;
pub(crate) mod known_obstacles;
pub mod obstacle;
pub(crate) mod obstacle_changes;
pub(crate) mod plugin;
pub(crate) mod solver_environment;
pub(crate) mod sync_obstacles;
pub(crate) mod wake_regions;
pub mod wind;
pub mod wind_zone;
