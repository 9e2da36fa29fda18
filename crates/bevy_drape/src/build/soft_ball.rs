//! Soft balls in the plane.

use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{BuildError, SoftBallBuilder};

use crate::body::fabric::Fabric;
use crate::body::particles::BodyParts;
use crate::build::description::Description;

/// A soft ball in the entity's XY plane: a jelly, a tyre, a wheel. Of its concentric rings of particles, ring `k` of
/// `n` has radius `radius (k + 1) / n` and `10 (k + 1)` particles (S26).
///
/// The first step after insertion or a change builds its [`Particles`](crate::body::particles::Particles) and
/// [`Sticks`](crate::body::particles::Sticks), and a mesh of filled triangles. It stays in the world's XY plane as long
/// as nothing pushes it out. In other planes rounding makes it buckle under long pressure.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct SoftBall {
    /// Radius in metres.
    pub radius: f32,
    /// Number of rings, from 1 to 256; 4 by default.
    pub rings: u32,
    /// Mass per area in kg/m^2; 10 by default.
    pub areal_density: f32,
    /// Stiffness of all sticks, 0 to 1; 0.999 by default. Below 0.98 it caves in when it is dropped.
    pub stiffness: f32,
    /// Damping along all sticks in 1/s; 1 by default.
    pub damping: f32,
    /// True if the outermost ring is fixed to the entity.
    pub pin_rim: bool,
}

impl Default for SoftBall {
    /// Half a metre in diameter.
    fn default() -> Self {
        Self { radius: 0.25, rings: 4, areal_density: 10.0, stiffness: 0.999, damping: 1.0, pin_rim: false }
    }
}

impl SoftBall {
    /// A ball of this radius in metres.
    pub fn new(radius: f32) -> Self {
        Self { radius, ..Self::default() }
    }

    /// Builds the particles and topology of this ball at `transform`. The greatest component of its scale counts.
    ///
    /// # Errors
    /// [`BuildError`] naming the field that cannot be used.
    pub fn build(&self, transform: &GlobalTransform) -> Result<BodyParts, BuildError> {
        let (scale, rotation, centre) = transform.to_scale_rotation_translation();
        let [right, up] = [rotation * Vec3::X, rotation * Vec3::Y];
        let mut builder = SoftBallBuilder::new(centre, self.radius * scale.abs().max_element(), self.rings)
            .axes(right, up)
            .areal_density(self.areal_density)
            .stiffness(self.stiffness)
            .damping(self.damping);
        if self.pin_rim {
            builder = builder.pin_rim();
        }
        let (particles, topology) = builder.build_parts()?;
        Ok((particles, Arc::new(topology)))
    }
}

impl Description for SoftBall {
    const NAME: &'static str = "SoftBall";

    fn build(&self, _: &Fabric, transform: &GlobalTransform) -> Result<BodyParts, BuildError> {
        self.build(transform)
    }
}
