//! Tied particles, from step to step.

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::attach::attachment::{Attachment, Tie, TiedParticles};

/// The tied particles of a body as of the last step.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct AttachmentState {
    /// The attachment that this was made for.
    pub made_of: Attachment,
    pub body: u64,
    /// The pose of each tie's entity in the last step; none for a missing entity.
    pub poses: Vec<Option<Affine3A>>,
    /// Sorted by particle.
    pub held: Vec<HeldParticle>,
}

/// A tied particle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct HeldParticle {
    pub particle: u32,
    /// Index of its tie.
    pub tie: u32,
    /// Its place in the coordinates of the tie's entity.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub local: Vec3,
    /// Inverse mass before it was tied, in 1/kg.
    pub inverse_mass: f32,
}

impl AttachmentState {
    /// Ties the particles that `attachment` asks for. A particle that was tied to the same entity keeps its place.
    /// Fails with the first missing index, after tying all others.
    pub fn make(
        &mut self,
        attachment: &Attachment,
        particles: &mut drape_solver::Particles,
        pose: impl Fn(Entity) -> Option<Affine3A>,
    ) -> Result<(), u32> {
        let before = core::mem::take(self);
        before.release(particles, |_| true);
        let mut missing = Ok(());
        let count = particles.len() as u32;
        let mut wanted = Vec::new();
        for (tie, Tie { entity, particles: tied }) in (0..).zip(&attachment.ties) {
            self.poses.push(pose(*entity));
            let indices: Vec<u32> = match tied {
                TiedParticles::Pinned => (0..count).filter(|&i| particles.is_pinned(i as usize)).collect(),
                TiedParticles::First => vec![0],
                TiedParticles::Last => vec![count.saturating_sub(1)],
                TiedParticles::Indices(indices) => indices.clone(),
            };
            for particle in indices {
                if particle >= count {
                    missing = missing.and(Err(particle));
                } else if self.poses[tie as usize].is_some() {
                    wanted.push((particle, tie));
                }
            }
        }
        // A stable sort, so that the last tie of a particle counts.
        wanted.sort_by_key(|&(particle, _)| particle);
        for (i, &(particle, tie)) in wanted.iter().enumerate() {
            if wanted.get(i + 1).is_some_and(|next| next.0 == particle) {
                continue;
            }
            let Some(pose) = self.poses[tie as usize] else { continue };
            let entity = attachment.ties[tie as usize].entity;
            let known = before.held.iter().find(|held| {
                held.particle == particle
                    && before.made_of.ties.get(held.tie as usize).is_some_and(|tie| tie.entity == entity)
            });
            let i = particle as usize;
            let local = known
                .map_or_else(|| pose.inverse().transform_point3(particles.position(i)), |held| held.local);
            let inverse_mass = particles.inverse_mass(i);
            if inverse_mass != 0.0 {
                particles.set_inverse_mass(i, 0.0);
            }
            self.held.push(HeldParticle { particle, tie, local, inverse_mass });
        }
        // Poses that differ from any other move all particles in this step.
        self.poses.iter_mut().flatten().for_each(|pose| *pose = Affine3A::NAN);
        self.made_of.clone_from(attachment);
        missing
    }

    /// True if a particle is tied.
    pub fn holds(&self, particle: u32) -> bool {
        self.held.binary_search_by_key(&particle, |held| held.particle).is_ok()
    }

    /// Releases the particles of some ties.
    pub fn release(&self, particles: &mut drape_solver::Particles, is_cut: impl Fn(u32) -> bool) {
        for held in self.held.iter().filter(|held| is_cut(held.tie)) {
            let i = held.particle as usize;
            if i < particles.len() && particles.is_pinned(i) && held.inverse_mass > 0.0 {
                particles.set_inverse_mass(i, held.inverse_mass);
            }
        }
    }

    /// Returns the tied particles of a torn body, or of a piece of it, whose particles have these origins.
    pub fn torn(&self, body: u64, origins: &[u32]) -> Self {
        let mut torn = Self { body, held: Vec::new(), ..self.clone() };
        for (particle, origin) in (0..).zip(origins) {
            let held = self.held.iter().find(|held| held.particle == *origin);
            torn.held.extend(held.map(|held| HeldParticle { particle, ..*held }));
        }
        for (place, tie) in (0..).zip(&mut torn.made_of.ties) {
            let held = torn.held.iter().filter(|held| held.tie == place);
            tie.particles = TiedParticles::Indices(held.map(|held| held.particle).collect());
        }
        torn
    }
}
