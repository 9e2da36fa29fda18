//! One run of one solver.
//!
//! Time and motion are measured in different runs: a run that is timed does nothing but steps, so that looking at
//! positions does not push the solver's data out of the caches; a run that is watched is not timed.

use std::sync::Arc;
use std::time::Duration;

use crate::contender::Failure;
use crate::drape::{on_threads, state_hash};
use crate::memory_pass::MemoryPass;
use crate::scene::{Scene, SceneKind};
use crate::solver::{Effort, Solver};
use crate::stretch::{Gauge, StretchFigures};

/// What to run.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The solver.
    pub solver: Solver,
    /// How hard it works.
    pub effort: Effort,
    /// Steps. The first tenth is neither timed nor counted as motion.
    pub steps: usize,
}

/// What a timed run showed.
pub struct Timing {
    /// Wall time of a step: mean over the timed steps.
    pub step: Duration,
    /// Hash of all positions at the end.
    pub hash: u64,
    /// The pass over memory that the step is compared with, in the scene that asks for it.
    pub memory_pass: Option<MemoryPass>,
}

/// What a watched run showed.
pub struct Motion {
    /// Stretch at the end.
    pub end: StretchFigures,
    /// Stretch in motion: means over steps.
    pub motion: StretchFigures,
    /// Mechanical energy at the end over that after the first step.
    pub energy_end_over_start: Option<f64>,
    /// Memory.
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

    /// Steps the scene through, and times it.
    ///
    /// # Errors
    /// [`Failure`] of the solver.
    pub fn time(&self) -> Result<Timing, Failure> {
        on_threads(self.effort.threads, || self.time_here())?
    }

    fn time_here(&self) -> Result<Timing, Failure> {
        let mut contender = self.solver.load(&self.scene, &self.effort)?;
        let mut wall = Duration::ZERO;
        for index in 0..self.steps {
            let step = contender.step()?;
            if index >= self.warm_up() {
                wall += step;
            }
        }
        let is_yardstick_wanted = self.scene.kind == SceneKind::Million;
        Ok(Timing {
            step: wall.div_f64((self.steps - self.warm_up()) as f64),
            hash: state_hash(&contender.positions()),
            memory_pass: is_yardstick_wanted.then(|| MemoryPass::measure(self.scene.particle_count())),
        })
    }

    /// Steps the scene through, and looks at it after every step.
    ///
    /// # Errors
    /// [`Failure`] of the solver.
    pub fn watch(&self) -> Result<Motion, Failure> {
        on_threads(self.effort.threads, || self.watch_here())?
    }

    fn watch_here(&self) -> Result<Motion, Failure> {
        let mut contender = self.solver.load(&self.scene, &self.effort)?;
        let mut gauge = Gauge::new(&self.scene.model);
        let mut sum = StretchFigures::default();
        let mut energy_start = None;
        for index in 0..self.steps {
            contender.step()?;
            if index == 0 {
                energy_start = contender.energy();
            }
            if index >= self.warm_up() {
                let now = gauge.read(&contender.positions());
                sum.rms += now.rms;
                sum.p99 += now.p99;
                sum.max += now.max;
            }
        }
        let watched = (self.steps - self.warm_up()) as f64;
        let positions = contender.positions();
        Ok(Motion {
            end: gauge.read(&positions),
            motion: StretchFigures { rms: sum.rms / watched, p99: sum.p99 / watched, max: sum.max / watched },
            energy_end_over_start: contender.energy().zip(energy_start).map(|(end, start)| end / start),
            bytes_per_particle: contender.bytes_per_particle(),
            isa: contender.isa(),
            hash: state_hash(&positions),
        })
    }
}
