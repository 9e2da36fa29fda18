//! Air inside a closed cloth.

use bevy::prelude::*;

use crate::body::particles::Particles;

/// Keeps the volume inside a closed body, in parts of that at rest: 1, the default, keeps it, 1.2 blows up a balloon, 0 lets it
/// be. From 0 to 1000. Nothing happens to a body whose faces are not closed.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct Pressure(pub f32);

impl Default for Pressure {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Wakes what has lost its air.
pub(crate) fn wake_slack(removed: On<Remove, Pressure>, mut bodies: Query<&mut Particles>) {
    if let Ok(mut particles) = bodies.get_mut(removed.entity) {
        particles.rouse();
    }
}

/// Wakes what is blown up or let go flat.
pub(crate) fn wake_pressed(mut bodies: Query<&mut Particles, Changed<Pressure>>) {
    for mut particles in &mut bodies {
        particles.rouse();
    }
}
