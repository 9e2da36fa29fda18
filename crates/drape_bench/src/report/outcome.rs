//! One line of the table.

use serde::Serialize;

use crate::measure::job::{Job, Motion, Timing};
use crate::measure::memory_pass::MemoryPass;
use crate::scenes::model::Pins;

/// One line of the table, in the order of its columns.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Name of the scene.
    pub scene: &'static str,
    /// Name of the solver.
    pub solver: &'static str,
    /// Size of the scene, as the scene counts it.
    pub n: u32,
    /// Substeps in a step.
    pub substeps: u32,
    /// Sweeps in a substep.
    pub sweeps: u32,
    /// The pinned particles.
    pub pins: Pins,
    /// Threads.
    pub threads: u32,
    /// Instruction set.
    pub isa: &'static str,
    /// Number of sticks of all bodies.
    pub sticks: usize,
    /// Median wall time of a step in milliseconds.
    pub ms_median: f64,
    /// Least wall time of a step in milliseconds.
    pub ms_min: f64,
    /// Median wall time over sticks x substeps x sweeps, in nanoseconds.
    pub ns_per_stick_sweep: f64,
    /// Speed as a multiple of that of the naive loop on the same scene; only in comparisons.
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
    /// Memory per particle in bytes.
    pub bytes_per_particle: Option<f64>,
    /// Mechanical energy at the end over that after the first step.
    pub energy_end_over_start: Option<f64>,
    /// Hash of all positions at the end.
    pub state_hash: String,
    /// True if all runs ended with equal positions, to the bit.
    #[serde(skip)]
    pub is_repeatable: bool,
    /// The pass over memory to compare with: the median one.
    #[serde(skip)]
    pub memory_pass: Option<MemoryPass>,
}

impl Outcome {
    /// The figures of a job that was watched once and timed at least once.
    ///
    /// # Panics
    /// If there is no timed run.
    pub fn new(job: &Job, motion: &Motion, mut runs: Vec<Timing>) -> Self {
        runs.sort_unstable_by_key(|run| run.step);
        let (least, median) = (&runs[0], &runs[runs.len() / 2]);
        let sticks = job.scene.stick_count();
        let work = sticks as f64 * f64::from(job.options.substeps) * f64::from(job.options.sweeps);
        let mut passes: Vec<MemoryPass> = runs.iter().filter_map(|run| run.memory_pass).collect();
        passes.sort_unstable_by_key(|pass| pass.time);
        Self {
            scene: job.scene.kind.name(),
            solver: job.solver.name,
            n: job.scene.n,
            substeps: job.options.substeps,
            sweeps: job.options.sweeps,
            pins: job.scene.pins,
            threads: job.options.threads,
            isa: motion.isa,
            sticks,
            ms_median: median.step.as_secs_f64() * 1e3,
            ms_min: least.step.as_secs_f64() * 1e3,
            ns_per_stick_sweep: median.step.as_secs_f64() * 1e9 / work,
            ratio_to_naive: None,
            stretch_rms_end: motion.end.rms,
            stretch_max_end: motion.end.max,
            stretch_rms_motion: motion.motion.rms,
            stretch_p99_motion: motion.motion.p99,
            stretch_max_motion: motion.motion.max,
            bytes_per_particle: motion.bytes_per_particle,
            energy_end_over_start: motion.energy_end_over_start,
            state_hash: format!("{:016x}", motion.hash),
            is_repeatable: runs.iter().all(|run| run.hash == motion.hash),
            memory_pass: passes.get(passes.len() / 2).copied(),
        }
    }

    /// True if both are of the same scene, size and pins.
    pub fn is_same_scene(&self, other: &Self) -> bool {
        (self.scene, self.n, self.pins) == (other.scene, other.n, other.pins)
    }
}

/// Fills in the ratios to the naive loop on the same scene.
pub fn fill_ratios(outcomes: &mut [Outcome]) {
    let is_naive = |outcome: &&Outcome| outcome.solver == "naive";
    let naive: Vec<Outcome> = outcomes.iter().filter(is_naive).cloned().collect();
    for outcome in outcomes {
        let same = naive.iter().find(|naive| naive.is_same_scene(outcome));
        outcome.ratio_to_naive = same.map(|naive| naive.ms_median / outcome.ms_median);
    }
}
