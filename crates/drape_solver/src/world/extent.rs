//! The boxes of bodies and balls, now and through a step.

use crate::state::ball::Ball;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::Topology;
use crate::world::bounds::Bounds;

/// The box of a body's particles, and their speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// The box around them, and around what they carry.
    pub bounds: Bounds,
    /// Greatest speed of one of them in m/s.
    pub greatest_speed: f32,
}

impl Extent {
    /// The extent of a body with these particles and this topology.
    pub fn of(particles: &Particles, topology: &Topology) -> Self {
        let bounds = Bounds::from(particles.bounds()).grown(topology.overhang());
        Self { bounds, greatest_speed: particles.greatest_speed() }
    }

    /// The box around the surface of the body at rest.
    pub fn surface(&self, settings: &BodySettings) -> Bounds {
        self.bounds.grown(settings.thickness)
    }

    /// The box that the surface of the body does not leave within a step of `dt` seconds under a gravity of size `gravity` (m/s^2).
    pub fn reach(&self, settings: &BodySettings, dt: f32, gravity: f32) -> Bounds {
        self.bounds.grown(settings.thickness + (self.greatest_speed + gravity * dt) * dt)
    }
}

/// The box around a ball.
pub fn ball_bounds(ball: &Ball) -> Bounds {
    Bounds::of_sphere(ball.position(), ball.material().radius)
}

/// The box that a ball does not leave within a step of `dt` seconds under a gravity of size `gravity` (m/s^2).
pub fn ball_reach(ball: &Ball, dt: f32, gravity: f32) -> Bounds {
    Bounds::of_sphere(ball.position(), ball.reach(dt, gravity))
}
