//! Data of bodies, balls and obstacles, and hashes of their state. Nothing here moves anything: kernels stand on the floors
//! above.
//!
//! ```
//! use drape_solver::glam::Vec3;
//! use drape_solver::state::measure::{mass, momentum, stretch};
//! use drape_solver::{BodySettings, ClothBuilder};
//!
//! let mut sheet = ClothBuilder::new(1.0, 1.0, 8, 8).build(BodySettings::default())?;
//! assert!(stretch(&sheet.particles, &sheet.topology).rms < 1e-6);
//! for particle in 0..sheet.particles.len() {
//!     sheet.particles.set_velocity(particle, Vec3::X * 2.0);
//! }
//! assert!((momentum(&sheet.particles).x - 2.0 * mass(&sheet.particles)).abs() < 1e-6);
//! # Ok::<(), drape_solver::BuildError>(())
//! ```
//!
//! Imports: `geometry`, `simd` and the ground. Callers: everything above.

pub(crate) mod animated_columns;
pub mod animated_particles;
pub mod backstops;
pub mod ball;
pub mod bending_friction;
pub mod bends;
pub mod body;
pub(crate) mod combine_rule;
pub mod crossings;
pub mod drag;
pub(crate) mod embedded_point;
pub mod face_part;
pub mod frame_motion;
pub(crate) mod friction;
pub(crate) mod grid;
pub mod hash;
pub(crate) mod joint;
pub mod layers;
pub(crate) mod layout;
pub mod measure;
pub mod membrane;
pub mod motion_limits;
pub mod obstacle;
mod obstacle_flight;
pub mod obstacle_motion;
pub mod obstacles;
pub(crate) mod particle_stats;
pub mod particles;
pub(crate) mod pose_constraints;
pub mod pose_drives;
mod pulled_way;
pub(crate) mod renumbering;
pub mod rigid_body;
pub mod settings;
pub mod snapshot;
pub(crate) mod star;
pub(crate) mod stick_list;
pub(crate) mod substep;
pub(crate) mod surface;
pub(crate) mod surface_leaf;
pub mod tethers;
pub mod topology;
pub(crate) mod torn_grid;
pub mod volume;
pub(crate) mod watch;
