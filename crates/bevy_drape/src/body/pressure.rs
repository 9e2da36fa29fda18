//! Air inside a closed cloth.

use bevy::prelude::*;

use crate::body::particles::Particles;

/// Keeps the volume inside a closed body, as a multiple of the volume at rest, from 0 to 1000: 1, the default, keeps
/// that, 1.2 inflates a balloon, 0 does nothing. Bodies with open faces are not affected.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct Pressure(pub f32);

impl Default for Pressure {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Wakes bodies that lose their pressure.
pub(crate) fn wake_slack(removed: On<Remove<Pressure>>, mut bodies: Query<&mut Particles>) {
    if let Ok(mut particles) = bodies.get_mut(removed.entity) {
        particles.rouse();
    }
}

/// Wakes bodies whose pressure changes.
pub(crate) fn wake_pressed(mut bodies: Query<&mut Particles, Changed<Pressure>>) {
    for mut particles in &mut bodies {
        particles.rouse();
    }
}
