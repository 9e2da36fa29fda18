//! The naive loop: an array of vectors, sticks one after another in natural order, with a square root each.
//!
//! It runs substeps x sweeps as sweeps of one step: in natural order, single sweeps with substeps blow up.

use crate::scenes::scene::Scene;
use crate::solvers::options::SolverOptions;
use crate::solvers::scalar_loop::ScalarLoop;

/// The naive loop on each body in turn.
pub fn naive(scene: &Scene, options: &SolverOptions) -> ScalarLoop {
    ScalarLoop::new(scene, &scene.model.natural_order, 1, options.substeps * options.sweeps)
}
