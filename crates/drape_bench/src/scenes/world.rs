//! Constants of all scenes: the step, gravity and the sphere.

use drape_solver::glam::Vec3;

/// Length of a step in seconds.
pub const STEP: f32 = 1.0 / 60.0;
/// Gravity in m/s^2.
pub const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
/// Radius of the static sphere, in metres.
pub const SPHERE_RADIUS: f32 = 0.5;
/// Centre of the sphere, in metres: 0.6 below the middle of the body.
pub const SPHERE_CENTRE: Vec3 = Vec3::new(0.0, -0.6, 0.0);
/// Side of a sheet or mesh, and length of a rope, in metres.
pub const SIDE: f32 = 2.0;
/// Mass of a body in kilograms, pinned particles counted.
pub const MASS: f32 = 1.0;
/// Height at which potential energy counts as zero, in metres: no particle of a sheet at its rest length can hang
/// lower than its diagonal below the pins.
pub const LOWEST: f32 = -2.83;
