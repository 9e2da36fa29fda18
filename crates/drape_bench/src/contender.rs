//! What every solver in the comparison can do.

use clap::ValueEnum;
use drape_solver::glam::Vec3;
use serde::Serialize;

use crate::coloured::Coloured;
use crate::drape::Drape;
use crate::naive::Naive;
use crate::workload::Sheet;

/// The solvers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Solver {
    /// This project's.
    Drape,
    /// A sequential Jakobsen loop in natural order, as a reader of the paper would write it.
    Naive,
    /// The same scalar code in independent order, with real substeps.
    Coloured,
}

/// A solver with the workload loaded.
pub trait Contender {
    /// Advances by one step of 1/60 s.
    fn step(&mut self);
    /// Positions of all particles.
    fn positions(&self) -> Vec<Vec3>;
    /// Kinetic and potential energy of the free particles in joules.
    fn energy(&self) -> f64;
    /// Memory per particle, sticks included, in bytes.
    fn bytes_per_particle(&self) -> f64;
    /// Instruction set that the kernels run on.
    fn isa(&self) -> &'static str {
        "scalar"
    }
}

impl Solver {
    /// Loads `sheet` into this solver.
    pub fn load(self, sheet: &Sheet, substeps: u32, sweeps: u32) -> Box<dyn Contender> {
        match self {
            Self::Drape => Box::new(Drape::new(sheet, substeps, sweeps)),
            Self::Naive => Box::new(Naive::new(sheet, substeps * sweeps)),
            Self::Coloured => Box::new(Coloured::new(sheet, substeps, sweeps)),
        }
    }

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drape => "drape",
            Self::Naive => "naive",
            Self::Coloured => "coloured",
        }
    }
}
