//! Bodies that stay in a plane: cloth and ropes in two dimensions.

use bevy::prelude::*;

use crate::body::particles::Particles;

/// Distance from the plane in metres below which particles are left alone: the rounding of a step would keep a body
/// awake.
const TOLERANCE: f32 = 1e-5;

/// Keeps a body in a plane of the world: after each step it puts particles back and removes their velocity along the
/// normal. For two dimensions. It changes nothing in the XY plane as long as nothing pushes sideways.
///
/// A body that is pushed out of its plane all the time does not fall asleep. Start flat: a cloth across the plane
/// collapses into a line.
///
/// Obstacles stay three-dimensional: use a sphere or cylinder centred on the plane for a disc, and a cuboid that
/// reaches far to both sides for a box.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct PlaneLock {
    /// Normal of the plane, of any length but zero; Z by default.
    pub normal: Vec3,
    /// Distance from the world's origin along the normal, in metres; 0 by default.
    pub distance: f32,
}

impl Default for PlaneLock {
    fn default() -> Self {
        Self { normal: Vec3::Z, distance: 0.0 }
    }
}

/// Puts particles back into their planes. A lock without a valid normal does nothing.
pub(crate) fn lock_planes(mut bodies: Query<(&PlaneLock, &mut Particles)>) {
    for (lock, mut particles) in &mut bodies {
        let Some(normal) = lock.normal.try_normalize().filter(|_| lock.distance.is_finite()) else {
            continue;
        };
        let particles = particles.bypass_change_detection();
        for i in 0..particles.len() {
            let off = particles.position(i).dot(normal) - lock.distance;
            if off.abs() <= TOLERANCE || particles.is_pinned(i) {
                continue;
            }
            let (position, velocity) = (particles.position(i), particles.velocity(i));
            if position.is_finite() && velocity.is_finite() {
                particles.set_position(i, position - normal * off);
                particles.set_velocity(i, velocity.reject_from_normalized(normal));
            }
        }
    }
}
