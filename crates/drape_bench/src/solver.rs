//! The solvers by name.

use clap::ValueEnum;

use crate::coloured::Coloured;
use crate::contender::{Contender, Failure};
use crate::drape::Drape;
use crate::naive::Naive;
#[cfg(feature = "plugin")]
use crate::plugin::Plugin;
use crate::scene::{Scene, SceneKind};

/// The solvers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Solver {
    /// This project's.
    Drape,
    /// A sequential Jakobsen loop in natural order, as a reader of the paper would write it.
    Naive,
    /// The same scalar code in independent order, with real substeps.
    Coloured,
    /// This project's, in Bevy.
    #[cfg(feature = "plugin")]
    Plugin,
}

/// How this project's solver moves the ends of a stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Projection {
    /// One square root a stick.
    Exact,
    /// One Newton step.
    SquareRootFree,
}

/// How hard a solver works.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Substeps in a step.
    pub substeps: u32,
    /// Sweeps in a substep.
    pub sweeps: u32,
    /// Threads.
    pub threads: u32,
    /// Of this project's solver.
    pub projection: Projection,
}

impl Solver {
    /// Loads `scene` into this solver.
    ///
    /// # Errors
    /// [`Failure`] if the solver cannot run it so.
    pub fn load(self, scene: &Scene, effort: &Effort) -> Result<Box<dyn Contender>, Failure> {
        let (solver, kind) = (self.name(), scene.kind);
        if kind == SceneKind::Asleep && !self.sleeps() {
            return Err(Failure::Scene { solver, scene: kind.name() });
        }
        if effort.threads > 1 && !self.has_threads() {
            return Err(Failure::Threads { solver, scene: "any scene", threads: effort.threads });
        }
        Ok(match self {
            Self::Drape => Box::new(Drape::new(scene, effort)?),
            Self::Naive => Box::new(Naive::new(scene, effort)),
            Self::Coloured => Box::new(Coloured::new(scene, effort)),
            #[cfg(feature = "plugin")]
            Self::Plugin => Box::new(Plugin::new(scene, effort)?),
        })
    }

    /// Whether the solver can use more than one thread.
    pub fn has_threads(self) -> bool {
        !matches!(self, Self::Naive | Self::Coloured)
    }

    fn sleeps(self) -> bool {
        !matches!(self, Self::Drape | Self::Naive | Self::Coloured)
    }

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drape => "drape",
            Self::Naive => "naive",
            Self::Coloured => "coloured",
            #[cfg(feature = "plugin")]
            Self::Plugin => "plugin",
        }
    }
}
