//! What every solver in the comparison can do.

use std::time::{Duration, Instant};

use drape_solver::StepError;
use drape_solver::glam::Vec3;
use thiserror::Error;

use crate::scene::SceneError;

/// A solver with a scene loaded.
pub trait Contender {
    /// Advances by one step of 1/60 s; how long that took.
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

/// Why a solver cannot run a scene.
#[derive(Debug, Error)]
pub enum Failure {
    /// The solver has no way to run the scene.
    #[error("{solver} cannot run the scene {scene}")]
    Scene {
        /// The solver.
        solver: &'static str,
        /// The scene.
        scene: &'static str,
    },
    /// The solver has no way to use that many threads.
    #[error("{solver} steps {scene} on one thread, not on {threads}")]
    Threads {
        /// The solver.
        solver: &'static str,
        /// What it would step.
        scene: &'static str,
        /// What was asked for.
        threads: u32,
    },
    /// The scene cannot be made.
    #[error("{0}")]
    Model(#[from] SceneError),
    /// Some choices of settings gain energy.
    #[error("{trials} trials gain energy, the first of them {first}")]
    Unstable {
        /// How many.
        trials: usize,
        /// The first.
        first: String,
    },
    /// Balls have passed through a curtain.
    #[error("{passed} of {shots} balls passed through the cloth")]
    Passed {
        /// How many.
        passed: usize,
        /// Of how many.
        shots: usize,
    },
    /// A scene ends in other bits than it used to.
    #[error(
        "scenes end in other bits than {file} says. If that is meant, write the new hashes there (`drape_bench hashes > \
         {file}`) and give the reason in the commit message.\nIt says:\n{golden}but now there are:\n{hashes}"
    )]
    Golden {
        /// The file.
        file: String,
        /// What it says.
        golden: String,
        /// What was found.
        hashes: String,
    },
    /// The threads cannot be started.
    #[error("no threads: {0}")]
    Pool(String),
    /// The solver refused the bodies: a bug in one of the two.
    #[error("{0}")]
    Build(#[from] drape_solver::BuildError),
    /// The solver refused the step.
    #[error("{0}")]
    Step(#[from] StepError),
    /// A peer cannot do what was asked for.
    #[error("{0}")]
    Peer(String),
    /// The bodies that should be at rest are not.
    #[error("{0} bodies never came to rest")]
    Restless(usize),
}

/// How long `work` takes.
pub fn timed(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}
