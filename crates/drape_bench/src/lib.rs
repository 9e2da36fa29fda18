//! Named scenes, this solver and its peers: what a step costs and how far the cloth stretches.
//!
//! `cargo run --release -p drape_bench -- run --n 128 --solver drape` measures one solver;
//! `compare --scene sheet --sizes 32,64,128 --solvers drape,naive,coloured` measures several in turns, so that
//! a noisy machine is noisy for all of them.
//!
//! `stability` checks that no choice of settings gains energy; `hashes` prints state hashes that must be equal on every
//! machine; `shots` counts the balls that pass through a curtain; `broad` measures many cloths among many obstacles,
//! `contacts` the cost per particle of each kind of contact, `contact` cloth and ropes against themselves, with the edges that
//! pass through triangles, `street` the savings by levels of detail, `torn` tearing and torn cloth, `quality` the cost of a step at which a sheet hardly stretches,
//! `presets` the named materials, `fabrics` those that a laboratory has measured, `gpu` (a feature) the solver on the GPU.
//!
//! This is also a library, so that the peers that need an old Bevy can be compiled separately, in `peers`: they pass their
//! own [`Solver`](solver::Solver)s to [`main_with`].
//!
//! # Floors
//!
//! Each folder of `src` is a floor, which imports only from floors below:
//!
//! ```text
//! command/      the command line and the program
//! experiments/  measurements with a question of their own, and Table 1
//! report/       results of jobs: table, CSV, JSON, plot, remarks; the progress bar
//! measure/      runs solvers on scenes; time, stretch, memory
//! solvers/      this project's solver, alone, in Bevy and on the GPU, and scalar loops
//! failure       failures of solvers and experiments
//! collision/    collision detection of balls and cloth by five methods
//! scenes/       the named scenes as data
//! random        random numbers that are equal on every machine
//! ```

pub mod collision;
mod command;
pub mod experiments;
mod failure;
pub mod measure;
pub mod random;
pub mod report;
pub mod scenes;
pub mod solvers;

pub use command::program::main_with;
pub use experiments::{bombardment, table1};
pub use failure::Failure;
pub use scenes::{scene, world};
pub use solvers::{options, simulation, solver};
