//! The naive code with two changes: sticks in independent order, and real substeps.

use std::time::Duration;

use drape_solver::glam::Vec3;

use crate::contender::{Contender, Failure, timed};
use crate::model::Model;
use crate::scalar::Scalar;
use crate::scene::Scene;
use crate::solver::Effort;
use crate::world::STEP;

/// As the naive loop, but no stick shares a particle with the ones next to it in the order.
pub struct Coloured {
    scalar: Scalar,
    substeps: u32,
    sweeps: u32,
}

impl Coloured {
    /// Loads `scene`.
    pub fn new(scene: &Scene, effort: &Effort) -> Self {
        let scalar = Scalar::new(scene, &independent_order(&scene.model));
        Self { scalar, substeps: effort.substeps, sweeps: effort.sweeps }
    }
}

/// All sticks, family by family, each split into batches that share no particle.
fn independent_order(model: &Model) -> Vec<[u32; 2]> {
    let mut order = Vec::new();
    for family in &model.families {
        let mut batches: Vec<Vec<[u32; 2]>> = Vec::new();
        // A bit for each batch that a particle is in already.
        let mut used = vec![0_u64; model.positions.len()];
        for &stick in &family.sticks {
            let [a, b] = stick.map(|end| end as usize);
            let batch = (used[a] | used[b]).trailing_ones().min(u64::BITS - 1) as usize;
            used[a] |= 1 << batch;
            used[b] |= 1 << batch;
            if batches.len() <= batch {
                batches.resize_with(batch + 1, Vec::new);
            }
            batches[batch].push(stick);
        }
        order.extend(batches.concat());
    }
    order
}

impl Contender for Coloured {
    fn step(&mut self) -> Result<Duration, Failure> {
        let h = STEP / self.substeps as f32;
        let Scalar { bodies, frame } = &mut self.scalar;
        Ok(timed(|| {
            for points in bodies {
                for _ in 0..self.substeps {
                    points.integrate(frame, h);
                    for _ in 0..self.sweeps {
                        points.relax(frame);
                        points.collide(frame);
                    }
                }
            }
        }))
    }

    fn positions(&self) -> Vec<Vec3> {
        self.scalar.positions()
    }

    fn energy(&self) -> Option<f64> {
        Some(self.scalar.energy(STEP / self.substeps as f32))
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        Some(self.scalar.bytes_per_particle())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Pins;
    use crate::{mesh, sheet};

    #[test]
    fn the_order_has_every_stick_once_and_neighbours_share_no_particle() {
        let mesh = mesh::mesh(1000, Pins::Corners).expect("a mesh");
        for (model, batches) in [(sheet::sheet(9, Pins::Corners), 12), (mesh, 40)] {
            let order = independent_order(&model);
            let sorted = |mut sticks: Vec<[u32; 2]>| {
                sticks.sort_unstable();
                sticks
            };
            let shares = |pair: &&[[u32; 2]]| pair[0].iter().any(|end| pair[1].contains(end));
            // Only where one batch ends and the next begins.
            assert!(order.windows(2).filter(shares).count() < batches);
            assert_eq!(sorted(order), sorted(model.natural_order));
        }
    }
}
