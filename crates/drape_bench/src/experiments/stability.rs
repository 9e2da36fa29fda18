//! Checks that no choice of settings gains energy.
//!
//! A sheet hangs from its pins and swings, or is first shaken: every particle is displaced at random by up to half a
//! spacing. From then on its mechanical energy must never exceed the initial energy by more than a thousandth of `m g
//! L`.
//!
//! Bringing a shaken sheet's sticks back to length takes work, so its initial energy is taken half a second later. Some
//! sticks are still far from their length then, and release their energy when they come free: a peak of some hundredths
//! that is gone in a few steps. Only the energy in the second half of the run must not exceed the initial energy; the
//! peak before is shown beside it.

use std::fmt::{self, Display, Formatter};

use comfy_table::{ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{Body, Environment, Island, Particles, step};
use indicatif::{ParallelProgressIterator, ProgressBar};
use rayon::prelude::*;

use crate::failure::Failure;
use crate::random::Random;
use crate::scenes::model::Pins;
use crate::scenes::scene::{Scene, SceneKind};
use crate::scenes::world::{GRAVITY, MASS, SIDE, STEP};
use crate::solvers::drape;
use crate::solvers::options::{Projection, SolverOptions};

/// Gain that counts as none, as a fraction of `m g L`.
pub const TOLERANCE: f64 = 1e-3;

/// Steps after which the energy of a shaken sheet is taken.
const STEPS_OF_SETTLING: usize = 30;

/// A choice of settings on a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    n: u32,
    pins: Pins,
    options: SolverOptions,
    has_tethers: bool,
    is_shaken: bool,
}

/// All choices for sheets of these sizes: pins, substeps from 1 to 64, sweeps in one direction and in pairs, both formulas
/// for sticks, lines or sweeps, with and without tethers, calm and shaken.
pub fn trials(sizes: &[u32]) -> Vec<Trial> {
    let mut trials = Vec::new();
    for choice in 0..1 << 6 {
        let is = |bit: u32| choice & (1 << bit) != 0;
        for (&n, substeps) in
            sizes.iter().flat_map(|n| [1, 2, 4, 8, 12, 16, 32, 64].map(|substeps| (n, substeps)))
        {
            let options = SolverOptions {
                substeps,
                sweeps: if is(0) { 2 } else { 1 },
                threads: 1,
                projection: if is(1) { Projection::Exact } else { Projection::SquareRootFree },
                lines: is(2),
                ..SolverOptions::default()
            };
            let pins = if is(3) { Pins::Edge } else { Pins::Corners };
            trials.push(Trial { n, pins, options, has_tethers: is(4), is_shaken: is(5) });
        }
    }
    trials
}

impl Trial {
    /// The greatest gain of energy in `steps` steps.
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses the sheet or a step.
    pub fn gain(&self, steps: usize) -> Result<Gain, Failure> {
        let scene = Scene::new(SceneKind::Sheet, self.n, self.pins)?;
        let mut settings = drape::settings(&self.options);
        settings.tethers = self.has_tethers;
        let mut particles = drape::particles(&scene.model, Vec3::ZERO)?;
        if self.is_shaken {
            shake(&mut particles, 0.5 * SIDE / (self.n - 1) as f32);
        }
        let topology = drape::topology(&scene.model)?;
        let mut island = Island::of_body(Body::new(particles, topology.into(), settings));
        let environment = Environment { dt: STEP, gravity: GRAVITY, ..Environment::default() };
        let settling = if self.is_shaken { STEPS_OF_SETTLING } else { 0 };
        for _ in 0..settling {
            step(&mut island, &environment)?;
        }
        let reference = energy(&island, Lag::Removed).max(energy(&island, Lag::Left));
        let scale = f64::from(MASS * GRAVITY.length() * SIDE);
        let mut gain = Gain { peak: f64::NEG_INFINITY, lasting: f64::NEG_INFINITY };
        for index in settling..steps {
            step(&mut island, &environment)?;
            let gained = (energy(&island, Lag::Left) - reference) / scale;
            gain.peak = gain.peak.max(gained);
            if !self.is_shaken || index >= steps / 2 {
                gain.lasting = gain.lasting.max(gained);
            }
        }
        Ok(gain)
    }
}

/// Energy beyond the initial energy, as a fraction of `m g L`.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// The greatest value.
    pub peak: f64,
    /// The greatest value that counts.
    pub lasting: f64,
}

impl Gain {
    /// True if it exceeds the tolerance.
    pub fn is_one(self) -> bool {
        self.lasting.is_nan() || self.lasting > TOLERANCE
    }
}

impl Display for Trial {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let Self { n, pins, options, has_tethers, is_shaken } = self;
        let SolverOptions { substeps, sweeps, projection, lines, .. } = options;
        write!(
            formatter,
            "n {n}, {pins:?}, {substeps} x {sweeps}, {projection:?}, lines {lines}, tethers {has_tethers}, \
             shaken {is_shaken}"
        )
    }
}

/// The treatment of displacements, which give the velocity half a substep ago.
#[derive(Clone, Copy, PartialEq)]
enum Lag {
    Left,
    /// Advanced by half a substep of free fall.
    Removed,
}

fn energy(island: &Island, lag: Lag) -> f64 {
    let body = &island.bodies[0];
    let late = measure::mechanical_energy(body, GRAVITY);
    if lag == Lag::Left {
        return late;
    }
    let half = 0.5 * STEP / body.settings.substeps as f32;
    let momentum = measure::momentum(&body.particles);
    let mass = measure::mass(&body.particles);
    let change = GRAVITY.as_dvec3() * f64::from(half);
    late + momentum.dot(change) + 0.5 * mass * change.length_squared()
}

/// Displaces every free particle by up to `most` metres.
fn shake(particles: &mut Particles, most: f32) {
    let mut random = Random::new(1);
    for i in 0..particles.len() {
        let offset = Vec3::from_array([(); 3].map(|()| random.either_side() as f32 * most));
        if !particles.is_pinned(i) {
            particles.set_position(i, particles.position(i) + offset);
        }
    }
}

/// Runs all trials for sheets of these sizes on all cores, and prints the worst of each size and number of substeps.
///
/// # Errors
/// [`Failure`] of a trial, or [`Failure::Unstable`] with the worst one if any gains energy.
pub fn report(sizes: &[u32], steps: usize) -> Result<(), Failure> {
    let trials = trials(sizes);
    let progress = ProgressBar::new(trials.len() as u64);
    let gains: Vec<Gain> =
        trials.par_iter().progress_with(progress).map(|trial| trial.gain(steps)).collect::<Result<_, _>>()?;
    let mut rows: Vec<(u32, u32)> = trials.iter().map(|trial| (trial.n, trial.options.substeps)).collect();
    rows.sort_unstable();
    rows.dedup();
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header(["n", "substeps", "trials", "peak / (m g L)", "greatest gain / (m g L)", "of"]);
    let all = || trials.iter().zip(&gains);
    for (n, substeps) in rows {
        let of_row = all().filter(|(trial, _)| (trial.n, trial.options.substeps) == (n, substeps));
        let count = of_row.clone().count();
        let peak = of_row.clone().map(|(_, gain)| gain.peak).fold(f64::NEG_INFINITY, f64::max);
        if let Some((trial, gain)) = of_row.max_by(|a, b| a.1.lasting.total_cmp(&b.1.lasting)) {
            let [peak, gain] = [peak, gain.lasting].map(|gain| format!("{gain:.1e}"));
            let figures = [n.to_string(), substeps.to_string(), count.to_string(), peak, gain];
            table.add_row(figures.into_iter().chain([trial.to_string()]));
        }
    }
    println!("{} trials of {steps} steps\n{table}", trials.len());
    let failed: Vec<_> = all().filter(|(_, gain)| gain.is_one()).collect();
    for (trial, gain) in &failed {
        println!("gains {:.1e}: {trial}", gain.lasting);
    }
    match failed.first() {
        Some((trial, _)) => Err(Failure::Unstable { trials: failed.len(), first: trial.to_string() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_that_is_thrown_up_is_seen_to_gain() {
        let trial = trials(&[9])[0];
        let scene = Scene::new(SceneKind::Sheet, trial.n, trial.pins).expect("a scene");
        let particles = drape::particles(&scene.model, Vec3::ZERO).expect("valid");
        let topology = drape::topology(&scene.model).expect("valid");
        let body = Body::new(particles, topology.into(), drape::settings(&trial.options));
        let mut island = Island::of_body(body);
        let before = energy(&island, Lag::Left);
        island.bodies[0].particles.set_velocity(40, Vec3::Y * 10.0);
        assert!(energy(&island, Lag::Left) > before);
    }

    #[test]
    fn no_choice_gains_energy_on_a_small_sheet() {
        for trial in trials(&[12]) {
            // 64 x 2 with lines is above its start for a second after it was shaken.
            let gain = trial.gain(180).expect("finite");
            assert!(!gain.is_one(), "{gain:?}: {trial}");
        }
    }
}
