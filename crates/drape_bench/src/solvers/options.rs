//! Options of solvers.

use clap::ValueEnum;
use drape_solver::Isa;

/// The formula by which this project's solver moves the ends of a stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Projection {
    /// One square root a stick.
    Exact,
    /// One Newton step.
    SquareRootFree,
}

/// Options of a solver. Peers use those that they have.
#[derive(Clone, Copy, Debug)]
pub struct SolverOptions {
    /// Substeps in a step.
    pub substeps: u32,
    /// Sweeps in a substep.
    pub sweeps: u32,
    /// Threads.
    pub threads: u32,
    /// The formula for sticks of this project's solver.
    pub projection: Projection,
    /// True if this project's solver solves rows and columns of structural sticks directly.
    pub lines: bool,
    /// The instruction set that this project's solver runs on.
    pub isa: Isa,
}

impl Default for SolverOptions {
    /// Eight substeps of one sweep, as in the tables.
    fn default() -> Self {
        Self {
            substeps: 8,
            sweeps: 1,
            threads: 1,
            projection: Projection::SquareRootFree,
            lines: false,
            isa: Isa::detected(),
        }
    }
}
