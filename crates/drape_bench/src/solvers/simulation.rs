//! Simulations: solvers with a scene loaded.

use std::time::{Duration, Instant};

use drape_solver::glam::Vec3;

use crate::failure::Failure;

/// A solver with a scene loaded.
pub trait Simulation {
    /// Advances by one step of 1/60 s. Returns the time that took.
    ///
    /// # Errors
    /// [`Failure`] if the solver gives up.
    fn step(&mut self) -> Result<Duration, Failure>;
    /// Positions of all particles in metres, body after body.
    fn positions(&self) -> Vec<Vec3>;
    /// Kinetic and potential energy of the free particles in joules, if it can be known.
    fn energy(&self) -> Option<f64>;
    /// Memory per particle, sticks included, in bytes, if it can be known.
    fn bytes_per_particle(&self) -> Option<f64>;
    /// Instruction set that the kernels run on.
    fn isa(&self) -> &'static str {
        "scalar"
    }
}

/// Times `work`.
pub fn timed(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}
