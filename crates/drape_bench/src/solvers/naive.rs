//! The naive loop: an array of vectors, sticks one after another in natural order, with a square root each.
//!
//! It runs substeps x sweeps as sweeps of one step: in natural order, single sweeps with substeps blow up.

use std::time::Duration;

use drape_solver::glam::Vec3;

use crate::failure::Failure;
use crate::scenes::scene::Scene;
use crate::scenes::world::STEP;
use crate::solvers::options::SolverOptions;
use crate::solvers::scalar::Scalar;
use crate::solvers::simulation::{Simulation, timed};

/// The naive loop on each body in turn.
pub struct Naive {
    scalar: Scalar,
    sweeps: u32,
}

impl Naive {
    /// Loads `scene`.
    pub fn new(scene: &Scene, options: &SolverOptions) -> Self {
        let scalar = Scalar::new(scene, &scene.model.natural_order);
        Self { scalar, sweeps: options.substeps * options.sweeps }
    }
}

impl Simulation for Naive {
    fn step(&mut self) -> Result<Duration, Failure> {
        let Scalar { bodies, frame } = &mut self.scalar;
        Ok(timed(|| {
            for points in bodies {
                points.integrate(frame, STEP);
                for _ in 0..self.sweeps {
                    points.relax(frame);
                    points.collide(frame);
                }
            }
        }))
    }

    fn positions(&self) -> Vec<Vec3> {
        self.scalar.positions()
    }

    fn energy(&self) -> Option<f64> {
        Some(self.scalar.energy(STEP))
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        Some(self.scalar.bytes_per_particle())
    }
}
