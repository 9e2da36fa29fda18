//! Free motion: forces, wind, the Verlet step, moving frames, drives towards an animated pose, and time at rest.
//!
//! `force.rs` sums up the forces, `air_force.rs` has that of the wind, `integrate.rs` the Verlet step, `rest.rs` the time at rest.
//!
//! ```
//! use drape_solver::glam::{DVec3, Vec3};
//! use drape_solver::motion::ballistics::{direction, elevation_for, position_at};
//! use drape_solver::motion::force::wind_force;
//! use drape_solver::{BodySettings, ClothBuilder, Environment, Wind};
//!
//! // A breeze of 3 m/s pushes a sheet that faces it.
//! let sheet = ClothBuilder::new(1.0, 1.0, 8, 8).build(BodySettings::default())?;
//! let breeze = Environment { wind: Wind::new(Vec3::Z * 3.0), ..Environment::default() };
//! assert!(wind_force(&sheet, &breeze).z > 1.0);
//!
//! // A cannon of 20 m/s hits what is 10 m away, at its own height.
//! let elevation = elevation_for(10.0, 0.0, 20.0, 9.81).expect("it is within range");
//! let seconds = 10.0 / (20.0 * elevation.cos());
//! let end = position_at(DVec3::ZERO, direction(elevation, 0.0) * 20.0, DVec3::NEG_Y * 9.81, seconds);
//! assert!(end.y.abs() < 1e-9);
//! # Ok::<(), drape_solver::BuildError>(())
//! ```
//!
//! Imports: `state` and below. Callers: `substep` and `step`.

pub(crate) mod air;
pub(crate) mod air_force;
pub mod ballistics;
pub(crate) mod body_columns;
pub mod environment;
pub mod force;
pub(crate) mod integrate;
pub(crate) mod moving_frame;
pub(crate) mod particle_stats;
pub(crate) mod pose_drive;
pub(crate) mod rest;
pub mod wind;
