//! One run of one solver.
//!
//! Time and motion are measured in different runs: a timed run only steps, so that reading positions does not push the
//! solver's data out of the caches; a watched run is not timed.

use std::sync::Arc;
use std::time::Duration;

use crate::failure::Failure;
use crate::measure::memory_pass::MemoryPass;
use crate::measure::stretch::{StretchFigures, StretchGauge};
use crate::scenes::scene::{Scene, SceneKind};
use crate::solvers::drape::state_hash;
use crate::solvers::options::SolverOptions;
use crate::solvers::solver::Solver;
use crate::solvers::threads::on_threads;

/// A solver, a scene and the number of steps.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The solver.
    pub solver: Solver,
    /// The options of the solver.
    pub options: SolverOptions,
    /// Steps. The first tenth is neither timed nor counted as motion.
    pub steps: usize,
}

/// Results of a timed run.
pub struct Timing {
    /// Mean wall time of a timed step.
    pub step: Duration,
    /// Hash of all positions at the end.
    pub hash: u64,
    /// The pass over memory that the step is compared with; only in the scene `million`.
    pub memory_pass: Option<MemoryPass>,
}

/// Results of a watched run.
pub struct Motion {
    /// Stretch at the end.
    pub end: StretchFigures,
    /// Stretch in motion: means over steps.
    pub motion: StretchFigures,
    /// Mechanical energy at the end over that after the first step.
    pub energy_end_over_start: Option<f64>,
    /// Memory per particle in bytes.
    pub bytes_per_particle: Option<f64>,
    /// Instruction set.
    pub isa: &'static str,
    /// Hash of all positions at the end.
    pub hash: u64,
}

impl Job {
    fn warm_up(&self) -> usize {
        self.steps / 10
    }

    /// Runs the scene, and times it.
    ///
    /// # Errors
    /// [`Failure`] of the solver.
    pub fn time(&self) -> Result<Timing, Failure> {
        on_threads(self.options.threads, || self.time_here())?
    }

    fn time_here(&self) -> Result<Timing, Failure> {
        let mut simulation = self.solver.load(&self.scene, &self.options)?;
        let mut wall = Duration::ZERO;
        for index in 0..self.steps {
            let step = simulation.step()?;
            if index >= self.warm_up() {
                wall += step;
            }
        }
        let is_yardstick_wanted = self.scene.kind == SceneKind::Million;
        Ok(Timing {
            step: wall.div_f64((self.steps - self.warm_up()) as f64),
            hash: state_hash(&simulation.positions()),
            memory_pass: is_yardstick_wanted.then(|| MemoryPass::measure(self.scene.particle_count())),
        })
    }

    /// Runs the scene, and measures it after every step.
    ///
    /// # Errors
    /// [`Failure`] of the solver.
    pub fn watch(&self) -> Result<Motion, Failure> {
        on_threads(self.options.threads, || self.watch_here())?
    }

    fn watch_here(&self) -> Result<Motion, Failure> {
        let mut simulation = self.solver.load(&self.scene, &self.options)?;
        let mut gauge = StretchGauge::new(&self.scene.model);
        let mut sum = StretchFigures::default();
        let mut energy_start = None;
        for index in 0..self.steps {
            simulation.step()?;
            if index == 0 {
                energy_start = simulation.energy();
            }
            if index >= self.warm_up() {
                let now = gauge.read(&simulation.positions());
                sum.rms += now.rms;
                sum.p99 += now.p99;
                sum.max += now.max;
            }
        }
        let watched = (self.steps - self.warm_up()) as f64;
        let positions = simulation.positions();
        Ok(Motion {
            end: gauge.read(&positions),
            motion: StretchFigures { rms: sum.rms / watched, p99: sum.p99 / watched, max: sum.max / watched },
            energy_end_over_start: simulation.energy().zip(energy_start).map(|(end, start)| end / start),
            bytes_per_particle: simulation.bytes_per_particle(),
            isa: simulation.isa(),
            hash: state_hash(&positions),
        })
    }
}
