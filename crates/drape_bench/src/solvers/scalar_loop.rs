//! The loop that the naive and the coloured solver share.

use std::time::Duration;

use drape_solver::glam::Vec3;

use crate::failure::Failure;
use crate::scenes::scene::Scene;
use crate::scenes::world::STEP;
use crate::solvers::scalar::Scalar;
use crate::solvers::simulation::{Simulation, timed};

/// Bodies one after another, each with substeps of integration, sticks in a fixed order, and the sphere.
pub struct ScalarLoop {
    scalar: Scalar,
    substeps: u32,
    sweeps: u32,
}

impl ScalarLoop {
    /// Loads `scene`, with its sticks in this `order`.
    pub fn new(scene: &Scene, order: &[[u32; 2]], substeps: u32, sweeps: u32) -> Self {
        Self { scalar: Scalar::new(scene, order), substeps, sweeps }
    }

    /// Length of a substep in seconds.
    fn substep(&self) -> f32 {
        STEP / self.substeps as f32
    }
}

impl Simulation for ScalarLoop {
    fn step(&mut self) -> Result<Duration, Failure> {
        let h = self.substep();
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
        Some(self.scalar.energy(self.substep()))
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        Some(self.scalar.bytes_per_particle())
    }
}
