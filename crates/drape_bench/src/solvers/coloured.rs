//! The naive code with two changes: sticks in independent order, and real substeps.

use std::time::Duration;

use drape_solver::glam::Vec3;

use crate::failure::Failure;
use crate::scenes::model::Model;
use crate::scenes::scene::Scene;
use crate::scenes::world::STEP;
use crate::solvers::options::SolverOptions;
use crate::solvers::scalar::Scalar;
use crate::solvers::simulation::{Simulation, timed};

/// The naive loop with sticks in an order in which neighbours share no particle, and with real substeps.
pub struct Coloured {
    scalar: Scalar,
    substeps: u32,
    sweeps: u32,
}

impl Coloured {
    /// Loads `scene`.
    pub fn new(scene: &Scene, options: &SolverOptions) -> Self {
        let scalar = Scalar::new(scene, &independent_order(&scene.model));
        Self { scalar, substeps: options.substeps, sweeps: options.sweeps }
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

impl Simulation for Coloured {
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
    use crate::scenes::model::Pins;
    use crate::scenes::{mesh, sheet};

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
