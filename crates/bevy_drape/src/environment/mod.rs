//! Obstacles, gravity and wind: everything that the solver's `Environment` holds.
//!
//! Imports `body/`. The plugin brings the components into the environment at the start of a step; `step/` hands the
//! environment to the solver.

pub mod dynamic_obstacle;
pub mod obstacle;
pub mod solver_environment;
pub mod wind_zone;
