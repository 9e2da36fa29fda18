//! A fingerprint of states: equal bits give equal hashes on every machine.
//!
//! Design: `docs/design/determinism.md`.

use core::hash::Hasher;

use twox_hash::XxHash3_64;

use crate::state::ball::Ball;
use crate::state::bending_friction::PlasticBends;
use crate::state::particles::Particles;

/// Collects states, in the order given, into one 64-bit hash.
#[derive(Default)]
pub struct StateHasher(XxHash3_64);

impl StateHasher {
    /// A hasher without states.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds positions, displacements and inverse masses of a body, and what friction keeps of its bends.
    pub fn particles(&mut self, particles: &Particles) -> &mut Self {
        self.values(&particles.origin.to_array());
        for slot in particles.layout.slots() {
            self.values(&particles.position.get(slot).to_array())
                .values(&particles.displacement.get(slot).to_array())
                .values(&[particles.inverse_mass[slot]]);
        }
        let PlasticBends { threads, edges } = &particles.plastic;
        for threads in threads.iter().filter(|threads| !threads.is_empty()) {
            particles.layout.slots().for_each(|slot| _ = self.values(&[threads[slot]]));
        }
        self.values(edges);
        self
    }

    /// Adds position, displacement, rotation and spin of a ball, and the number of substeps that it needs.
    pub fn ball(&mut self, ball: &Ball) -> &mut Self {
        self.values(&ball.position.to_array())
            .values(&ball.displacement.to_array())
            .values(&ball.rotation.to_array())
            .values(&ball.spin.to_array())
            .values(&[ball.hit_substeps])
    }

    /// Adds numbers of any other state, such as that of a rigid body.
    pub fn numbers(&mut self, numbers: &[f32]) -> &mut Self {
        self.values(numbers)
    }

    /// The hash of all that was added.
    pub fn finish(&self) -> u64 {
        self.0.finish()
    }

    fn values(&mut self, values: &[f32]) -> &mut Self {
        for value in values {
            self.0.write(&value.to_bits().to_le_bytes());
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn what_friction_keeps_of_bends_counts() {
        let particles = Particles::new(Vec3::ZERO, &[Vec3::X, Vec3::Y], &[1.0, 0.0]).expect("valid");
        let hash = |particles: &Particles| StateHasher::new().particles(particles).finish();
        let [mut of_grid, mut of_mesh] = [particles.clone(), particles.clone()];
        of_grid.plastic.reserve_threads(&particles.layout);
        of_grid.plastic.threads[1][1] = 1.0;
        of_mesh.plastic.edges.push(1.0);
        let all = [&particles, &of_grid, &of_mesh].map(hash);
        assert!(all[0] != all[1] && all[0] != all[2] && all[1] != all[2], "{all:?}");
    }
}
