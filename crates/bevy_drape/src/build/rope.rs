//! Ropes.

use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{BuildError, RopeBuilder};

use crate::body::fabric::Fabric;
use crate::body::particles::BodyParts;
use crate::build::description::Description;

/// A rope, cable or chain, straight between two points at first.
///
/// The first step after insertion or a change builds its [`Particles`](crate::body::particles::Particles) and
/// [`Sticks`](crate::body::particles::Sticks). Pinned ends stay fixed to the entity. Its
/// [`BodySurface`](crate::body::surface::BodySurface) has its thickness.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct Rope {
    /// First end in the entity's coordinates, in metres.
    pub start: Vec3,
    /// Last end in the entity's coordinates, in metres.
    pub end: Vec3,
    /// Number of particles, at least 2.
    pub particles: u32,
    /// Mass per length in kg/m.
    pub linear_density: f32,
    /// Additional mass at the last end in kg, 0 (the default) or more: a bucket, a wrecking ball.
    pub end_mass: f32,
    /// Stiffness against stretching, 0 to 1.
    pub stretch_stiffness: f32,
    /// Stiffness against bending, 0 (limp) to 1.
    pub bend_stiffness: f32,
    /// Damping along the links in 1/s.
    pub damping: f32,
    /// True if the first end is fixed to the entity.
    pub pin_start: bool,
    /// True if the last end is fixed to the entity.
    pub pin_end: bool,
}

impl Default for Rope {
    fn default() -> Self {
        Self {
            start: Vec3::ZERO,
            end: Vec3::NEG_Y,
            particles: 32,
            linear_density: 0.1,
            end_mass: 0.0,
            stretch_stiffness: 1.0,
            bend_stiffness: 0.0,
            damping: 0.0,
            pin_start: true,
            pin_end: false,
        }
    }
}

impl Rope {
    /// A limp rope of `particles` particles between two points in the entity's coordinates, its start pinned.
    pub fn new(start: Vec3, end: Vec3, particles: u32) -> Self {
        Self { start, end, particles, ..Self::default() }
    }

    /// Builds the particles and topology of this rope at `transform`.
    ///
    /// # Errors
    /// [`BuildError`] naming the field that cannot be used.
    pub fn build(&self, transform: &GlobalTransform) -> Result<BodyParts, BuildError> {
        let [start, end] = [self.start, self.end].map(|end| transform.transform_point(end));
        let (particles, topology) = self.builder(start, end).end_mass(self.end_mass).build_parts()?;
        Ok((particles, Arc::new(topology)))
    }

    /// Describes the rope between two points of the world to the solver, without the mass at its end.
    pub(crate) fn builder(&self, start: Vec3, end: Vec3) -> RopeBuilder {
        let mut builder = RopeBuilder::new(start, end, self.particles)
            .linear_density(self.linear_density)
            .stretch_stiffness(self.stretch_stiffness)
            .bend_stiffness(self.bend_stiffness)
            .damping(self.damping);
        if self.pin_start {
            builder = builder.pin_start();
        }
        if self.pin_end {
            builder = builder.pin_end();
        }
        builder
    }
}

impl Description for Rope {
    const NAME: &'static str = "Rope";

    fn build(&self, _: &Fabric, transform: &GlobalTransform) -> Result<BodyParts, BuildError> {
        self.build(transform)
    }
}
