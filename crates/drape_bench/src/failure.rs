//! Failures of solvers and experiments.

use drape_solver::StepError;
use thiserror::Error;

use crate::scenes::scene::SceneError;

/// The failure of a solver or an experiment.
#[derive(Debug, Error)]
pub enum Failure {
    /// The solver cannot run the scene.
    #[error("{solver} cannot run the scene {scene}")]
    Scene {
        /// The solver.
        solver: &'static str,
        /// The scene.
        scene: &'static str,
    },
    /// The solver cannot use that many threads.
    #[error("{solver} steps {scene} on one thread, not on {threads}")]
    Threads {
        /// The solver.
        solver: &'static str,
        /// The scene.
        scene: &'static str,
        /// The requested number of threads.
        threads: u32,
    },
    /// The scene cannot be made.
    #[error("{0}")]
    Model(#[from] SceneError),
    /// Some choices of settings gain energy.
    #[error("{trials} trials gain energy, the first of them {first}")]
    Unstable {
        /// Their number.
        trials: usize,
        /// The first of them.
        first: String,
    },
    /// Balls have passed through a curtain.
    #[error("{passed} of {shots} balls passed through the cloth")]
    Passed {
        /// Their number.
        passed: usize,
        /// The number of all balls.
        shots: usize,
    },
    /// The final state of a scene has changed.
    #[error(
        "scenes end in other bits than {file} says. If that is meant, write the new hashes there (`drape_bench hashes > \
         {file}`) and give the reason in the commit message.\nIt says:\n{golden}but now there are:\n{hashes}"
    )]
    Golden {
        /// The file.
        file: String,
        /// The hashes in the file.
        golden: String,
        /// The hashes that were found.
        hashes: String,
    },
    /// The threads cannot be started.
    #[error("no threads: {0}")]
    Pool(String),
    /// The solver refused the bodies: a bug in one of the two.
    #[error("{0}")]
    Build(#[from] drape_solver::BuildError),
    /// The solver refused a mesh.
    #[error("{0}")]
    Mesh(#[from] drape_solver::MeshError),
    /// The solver refused the step.
    #[error("{0}")]
    Step(#[from] StepError),
    /// The GPU cannot run the scene.
    #[cfg(feature = "gpu")]
    #[error("{0}")]
    Gpu(#[from] drape_gpu::GpuError),
    /// A peer cannot run the scene with these options.
    #[error("{0}")]
    Peer(String),
    /// The bodies that should be at rest are not.
    #[error("{0} bodies never came to rest")]
    Restless(usize),
}
