//! One run of one solver, and the figures of several.

use std::time::{Duration, Instant};

use serde::Serialize;

use crate::contender::Solver;
use crate::drape::state_hash;
use crate::workload::{Pins, SIDE, STEPS, Sheet, StretchFigures, WARM_UP};

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// The sheet.
    pub sheet: Sheet,
    /// The solver.
    pub solver: Solver,
    /// Substeps in a step.
    pub substeps: u32,
    /// Sweeps in a substep.
    pub sweeps: u32,
    /// Steps.
    pub steps: usize,
}

/// What one run showed.
pub struct Run {
    /// Wall time of a step: mean over the timed steps.
    step: Duration,
    end: StretchFigures,
    motion: StretchFigures,
    energy_end_over_start: f64,
    bytes_per_particle: f64,
    isa: &'static str,
    hash: u64,
}

/// One line of the table, in the order of its columns.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Name of the scene.
    pub scene: &'static str,
    /// Name of the solver.
    pub solver: &'static str,
    /// Particles in a row.
    pub n: u32,
    /// Substeps in a step.
    pub substeps: u32,
    /// Sweeps in a substep.
    pub sweeps: u32,
    /// Which particles are pinned.
    pub pins: Pins,
    /// Threads.
    pub threads: u32,
    /// Instruction set.
    pub isa: &'static str,
    /// Number of sticks.
    pub sticks: usize,
    /// Median wall time of a step.
    pub ms_median: f64,
    /// Least wall time of a step.
    pub ms_min: f64,
    /// Median wall time over sticks x substeps x sweeps.
    pub ns_per_stick_sweep: f64,
    /// How many times faster than the naive loop at the same size; only in comparisons.
    pub ratio_to_naive: Option<f64>,
    /// Stretch at the end, root mean square.
    pub stretch_rms_end: f64,
    /// Stretch at the end, greatest.
    pub stretch_max_end: f64,
    /// Stretch in motion, root mean square, mean over steps.
    pub stretch_rms_motion: f64,
    /// Stretch in motion, 99th percentile, mean over steps.
    pub stretch_p99_motion: f64,
    /// Stretch in motion, greatest, mean over steps.
    pub stretch_max_motion: f64,
    /// Memory.
    pub bytes_per_particle: f64,
    /// Mechanical energy at the end over that after the first step.
    pub energy_end_over_start: f64,
    /// Hash of all positions at the end.
    pub state_hash: String,
}

/// Steps `job` through and watches it. Only the steps themselves are timed.
pub fn measure(job: &Job) -> Run {
    let mut contender = job.solver.load(&job.sheet, job.substeps, job.sweeps);
    let [horizontal, vertical, ..] = job.sheet.families();
    let structural = [horizontal, vertical].concat();
    let rest = f64::from(SIDE) / f64::from(job.sheet.n - 1);
    let warm_up = job.steps * WARM_UP / STEPS;
    let mut wall = Duration::ZERO;
    let mut motion = StretchFigures::default();
    let mut energy_start = 0.0;
    for index in 0..job.steps {
        let start = Instant::now();
        contender.step();
        let elapsed = start.elapsed();
        if index == 0 {
            energy_start = contender.energy();
        }
        if index >= warm_up {
            wall += elapsed;
            let now = StretchFigures::of(&structural, rest, &contender.positions());
            motion.rms += now.rms;
            motion.p99 += now.p99;
            motion.max += now.max;
        }
    }
    let timed = (job.steps - warm_up) as f64;
    let positions = contender.positions();
    Run {
        step: wall.div_f64(timed),
        end: StretchFigures::of(&structural, rest, &positions),
        motion: StretchFigures { rms: motion.rms / timed, p99: motion.p99 / timed, max: motion.max / timed },
        energy_end_over_start: contender.energy() / energy_start,
        bytes_per_particle: contender.bytes_per_particle(),
        isa: contender.isa(),
        hash: state_hash(&positions),
    }
}

impl Outcome {
    /// The figures of repeated runs of `job`.
    ///
    /// # Panics
    /// If there is no run.
    pub fn new(job: &Job, mut runs: Vec<Run>) -> Self {
        runs.sort_unstable_by_key(|run| run.step);
        let (least, median) = (&runs[0], &runs[runs.len() / 2]);
        let sticks: usize = job.sheet.families().iter().map(Vec::len).sum();
        let work = sticks as f64 * f64::from(job.substeps) * f64::from(job.sweeps);
        Self {
            scene: "sheet",
            solver: job.solver.name(),
            n: job.sheet.n,
            substeps: job.substeps,
            sweeps: job.sweeps,
            pins: job.sheet.pins,
            threads: 1,
            isa: median.isa,
            sticks,
            ms_median: median.step.as_secs_f64() * 1e3,
            ms_min: least.step.as_secs_f64() * 1e3,
            ns_per_stick_sweep: median.step.as_secs_f64() * 1e9 / work,
            ratio_to_naive: None,
            stretch_rms_end: median.end.rms,
            stretch_max_end: median.end.max,
            stretch_rms_motion: median.motion.rms,
            stretch_p99_motion: median.motion.p99,
            stretch_max_motion: median.motion.max,
            bytes_per_particle: median.bytes_per_particle,
            energy_end_over_start: median.energy_end_over_start,
            state_hash: format!("{:016x}", median.hash),
        }
    }
}
