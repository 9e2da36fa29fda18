//! The solvers: this project's, alone, in Bevy and on the GPU, and two scalar loops to compare with.
//!
//! Import `scenes`. [`Solver`](solver::Solver) finds one by name and loads a scene; called by `measure` and experiments.

pub mod coloured;
pub mod drape;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod naive;
pub mod options;
#[cfg(feature = "plugin")]
pub mod plugin;
pub mod scalar;
pub mod scalar_loop;
pub mod simulation;
pub mod solver;
pub mod threads;
