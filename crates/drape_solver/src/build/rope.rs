//! The builder of ropes.
//!
//! Design: `docs/design/ropes.md`.

use std::sync::Arc;

use glam::Vec3;

use crate::build::topology_builder::TopologyBuilder;
use crate::error::{BuildError, finite_vector, positive};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::{StickKind, StickMaterial, Topology};

/// A chain of particles, straight from one end to the other at rest.
#[derive(Clone, Debug)]
pub struct RopeBuilder {
    start: Vec3,
    end: Vec3,
    particles: u32,
    linear_density: f32,
    end_mass: f32,
    stretch_stiffness: f32,
    bend_stiffness: f32,
    damping: f32,
    pins: Vec<u32>,
}

impl RopeBuilder {
    /// A rope of `particles` particles from `start` to `end` (metres): 0.1 kg/m, inextensible, limp, not pinned.
    pub fn new(start: Vec3, end: Vec3, particles: u32) -> Self {
        Self {
            start,
            end,
            particles,
            linear_density: 0.1,
            end_mass: 0.0,
            stretch_stiffness: 1.0,
            bend_stiffness: 0.0,
            damping: 0.0,
            pins: Vec::new(),
        }
    }

    /// Mass per length in kg/m, above zero.
    pub fn linear_density(mut self, linear_density: f32) -> Self {
        self.linear_density = linear_density;
        self
    }

    /// Mass in kg that the last particle carries besides its own, 0 (the default) or more: a bucket, a wrecking ball.
    pub fn end_mass(mut self, end_mass: f32) -> Self {
        self.end_mass = end_mass;
        self
    }

    /// Stiffness of the links, 0 (slack) to 1 (rigid): resists stretching. 1 by default.
    pub fn stretch_stiffness(mut self, stiffness: f32) -> Self {
        self.stretch_stiffness = stiffness;
        self
    }

    /// Stiffness of the sticks that skip a particle, 0 to 1: resists bending. 0 by default.
    pub fn bend_stiffness(mut self, stiffness: f32) -> Self {
        self.bend_stiffness = stiffness;
        self
    }

    /// Damping along the links in 1/s.
    pub fn damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }

    /// Pins one particle.
    pub fn pin(mut self, index: u32) -> Self {
        self.pins.push(index);
        self
    }

    /// Pins the first particle.
    pub fn pin_start(self) -> Self {
        self.pin(0)
    }

    /// Pins the last particle.
    pub fn pin_end(self) -> Self {
        let last = self.particles.saturating_sub(1);
        self.pin(last)
    }

    /// Builds the particles and the topology.
    ///
    /// # Errors
    /// [`BuildError`] that names the invalid value.
    pub fn build_parts(self) -> Result<(Particles, Topology), BuildError> {
        let count = self.particles;
        if count < 2 {
            return Err(BuildError::TooFewParticles { body: "a rope", needed: 2, found: count });
        }
        if u64::from(count) > crate::build::cloth::MAX_PARTICLES {
            let (found, limit) = (u64::from(count), crate::build::cloth::MAX_PARTICLES);
            return Err(BuildError::TooManyParticles { found, limit });
        }
        finite_vector("start", self.start)?;
        finite_vector("end", self.end)?;
        positive("linear_density", self.linear_density)?;
        if self.end_mass != 0.0 {
            positive("end_mass", self.end_mass)?;
        }
        let length = positive("length", self.start.distance(self.end))?;
        let links = count - 1;
        let positions: Vec<Vec3> =
            (0..count).map(|i| self.start.lerp(self.end, i as f32 / links as f32)).collect();
        let link_mass = self.linear_density * length / links as f32;
        let mass = |i: u32| match i {
            0 => 0.5 * link_mass,
            i if i == links => 0.5 * link_mass + self.end_mass,
            _ => link_mass,
        };
        let mut inverse_masses: Vec<f32> = (0..count).map(|i| 1.0 / mass(i)).collect();
        for &index in &self.pins {
            let slot = inverse_masses.get_mut(index as usize);
            *slot.ok_or(BuildError::NoSuchParticle { what: "a pin", index, count })? = 0.0;
        }
        let material = |kind, stiffness| StickMaterial {
            stiffness,
            damping: self.damping,
            ..StickMaterial::rigid(kind)
        };
        let structural = material(StickKind::Structural, self.stretch_stiffness);
        let mut builder = TopologyBuilder::grid(&positions, count, 1)?;
        builder
            .grid_family(structural, [1, 0])?
            .grid_family(material(StickKind::Bend, self.bend_stiffness), [2, 0])?
            .segments((0..links).map(|i| [i, i + 1]))?
            .straight_tethers(&self.pins)?;
        let particles = Particles::new(self.start, &positions, &inverse_masses)?;
        Ok((particles, builder.build()?))
    }

    /// Builds a body with these settings.
    ///
    /// # Errors
    /// [`BuildError`] that names the invalid value.
    pub fn build(self, settings: BodySettings) -> Result<Body, BuildError> {
        settings.validate()?;
        let (particles, topology) = self.build_parts()?;
        Ok(Body::new(particles, Arc::new(topology), settings))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rope_has_its_links_length_and_mass() {
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 3.0, 31).linear_density(0.2);
        let (particles, topology) = rope.build_parts().expect("valid");
        assert_eq!(topology.stick_count(), 30 + 29);
        assert!((crate::state::measure::mass(&particles) - 0.6).abs() < 1e-6);
        let length: f32 = (0..30).map(|i| topology.rest_length(i)).sum();
        assert!((length - 3.0).abs() < 1e-5);
    }

    #[test]
    fn a_weight_hangs_at_the_last_particle() {
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 3.0, 31).linear_density(0.2).end_mass(5.0);
        let (particles, _) = rope.build_parts().expect("valid");
        assert!((crate::state::measure::mass(&particles) - 5.6).abs() < 1e-5);
        assert!((1.0 / particles.inverse_mass(30) - 5.01).abs() < 1e-5);
    }

    #[test]
    fn what_cannot_be_built_is_refused() {
        let (a, b) = (Vec3::ZERO, Vec3::X);
        for rope in [
            RopeBuilder::new(a, b, 1),
            RopeBuilder::new(a, a, 4),
            RopeBuilder::new(a, b, 4).end_mass(-1.0),
            RopeBuilder::new(a, b, 4).end_mass(f32::NAN),
            RopeBuilder::new(a, Vec3::NAN, 4),
            RopeBuilder::new(a, b, 4).linear_density(0.0),
            RopeBuilder::new(a, b, 4).pin(4),
            RopeBuilder::new(a, b, 4).stretch_stiffness(1.5),
            RopeBuilder::new(a, b, u32::MAX),
        ] {
            assert!(rope.build_parts().is_err());
        }
    }
}
