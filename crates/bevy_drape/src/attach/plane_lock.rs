//! Bodies that stay in a plane: cloth and ropes in two dimensions.

use bevy::prelude::*;

use crate::body::particles::Particles;

/// What a particle may be off its plane before it is put back, in metres: what rounding makes in a step is left, so that a body
/// can fall asleep.
const TOLERANCE: f32 = 1e-5;

/// Keeps a body in a plane of the world: after each step its particles are put back, and what took them out of it is taken off
/// their velocity. For two dimensions: in the plane of X and Y where nothing pushes sideways, it changes nothing.
///
/// A body that something keeps pushing out of its plane does not fall asleep. Start flat: a cloth that stands
/// edge on to its plane becomes a bundle in a line.
///
/// Obstacles are bodies of three dimensions: a disc is a sphere or a cylinder whose middle is in the plane, a box a cuboid that
/// reaches far to both sides of it.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct PlaneLock {
    /// Normal of the plane, of any length but zero; Z by default.
    pub normal: Vec3,
    /// How far it is from the world's origin along the normal, in metres; 0 by default.
    pub distance: f32,
}

impl Default for PlaneLock {
    fn default() -> Self {
        Self { normal: Vec3::Z, distance: 0.0 }
    }
}

/// Puts particles back into their planes. A lock that is no plane does nothing.
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
