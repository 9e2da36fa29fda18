//! Table 1 of the founding paper (Liu Yuan 2019), re-run: milliseconds of collision detection per shot by five methods.
//!
//! The solver bombards the curtain once. All methods process each state one after the other, each time in another
//! order, so that a noisy machine is noisy for all of them and no method always finds its data cold or warm. Each
//! method exists several times, and each of these instances keeps its own caches: the median of their times for a state
//! counts, and beside it the least. Positions of particles and balls come in the form that a method needs, free of
//! charge; building, refitting and querying its own structures is timed. Steps in which no ball can come near the cloth
//! cost each method its broad phase only.
//!
//! In each substep the states are those after free flight, when contacts are deepest. A solver queries again after each
//! iteration; that would multiply all narrow phases by the same number.

use std::time::{Duration, Instant};

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;

use crate::collision::brute_force::ExactContacts;
use crate::collision::{Method, State, all};
use crate::experiments::bombardment::{Bombardment, Observer};
use crate::failure::Failure;
use crate::measure::median::median;

/// Number of instances of each method.
const REPEATS: usize = 5;

/// One method's figures.
#[derive(Clone, Debug, Serialize)]
pub struct MethodReport {
    /// Its name.
    pub name: &'static str,
    /// Time of collision detection of each shot in milliseconds, as sums of medians.
    pub ms_per_shot: Vec<f64>,
    /// Time of collision detection of each shot in milliseconds, as sums of the least times.
    pub least_ms_per_shot: Vec<f64>,
    /// Its time for all shots over that of the first method.
    pub ratio_to_ours: f64,
    /// The same ratio of the least times.
    pub least_ratio_to_ours: f64,
    /// Fraction of its time in the broad phase.
    pub broad_phase_share: f64,
    /// Number of faces that were queried for their nearest point.
    pub queries: usize,
    /// Number of contacts that it missed.
    pub missed: usize,
    /// Number of contacts that it found and that are none.
    pub false_contacts: usize,
}

/// All methods on one curtain.
#[derive(Clone, Debug, Serialize)]
pub struct CurtainReport {
    /// Particles in a row and in a column.
    pub particles: [u32; 2],
    /// Steps in which a ball could meet the cloth.
    pub steps_near: usize,
    /// Substeps in them, in which contacts were queried.
    pub states: usize,
    /// Contacts deeper than the tolerance, by brute force.
    pub contacts: usize,
    /// The methods, ours first.
    pub methods: Vec<MethodReport>,
}

/// Times for one shot.
#[derive(Clone, Copy, Default)]
struct Times {
    median: Duration,
    least: Duration,
}

impl Times {
    fn add(&mut self, times: &mut [Duration]) {
        self.median += median(times);
        self.least += times[0];
    }
}

/// Several instances of a method, and their results.
struct MethodRuns {
    instances: Vec<Box<dyn Method>>,
    /// Times of the instances for the current state.
    times: Vec<Duration>,
    broad: Vec<Times>,
    narrow: Vec<Times>,
    queries: usize,
    missed: usize,
    false_contacts: usize,
}

/// Compares all methods on the states of a bombardment.
struct MethodComparison {
    runs: Vec<MethodRuns>,
    /// The method that is first, which changes with every state.
    turn: usize,
    /// The time of reading the clock.
    clock: Duration,
    is_near: bool,
    steps_near: usize,
    states: usize,
    contacts: usize,
}

impl MethodComparison {
    fn new(shots: usize) -> Self {
        let mut instances: Vec<_> = (0..REPEATS).map(|_| all().into_iter()).collect();
        let mut runs = Vec::new();
        loop {
            let instances: Vec<_> = instances.iter_mut().filter_map(Iterator::next).collect();
            if instances.is_empty() {
                break;
            }
            runs.push(MethodRuns {
                instances,
                times: Vec::new(),
                broad: vec![Times::default(); shots],
                narrow: vec![Times::default(); shots],
                queries: 0,
                missed: 0,
                false_contacts: 0,
            });
        }
        let clock = (0..1000).map(|_| Instant::now().elapsed()).min().unwrap_or_default();
        Self { runs, turn: 0, clock, is_near: false, steps_near: 0, states: 0, contacts: 0 }
    }

    /// Times `work` on every instance of every method, in turns.
    fn time(&mut self, mut work: impl FnMut(&mut dyn Method)) {
        self.runs.iter_mut().for_each(|runs| runs.times.clear());
        let count = self.runs.len();
        for instance in 0..REPEATS {
            self.turn += 1;
            for place in 0..count {
                let runs = &mut self.runs[(place + self.turn) % count];
                let method = &mut *runs.instances[instance];
                let start = Instant::now();
                work(method);
                let taken = start.elapsed();
                runs.times.push(taken.saturating_sub(self.clock));
            }
        }
    }
}

impl Observer for MethodComparison {
    fn begin_step(&mut self, shot: usize, state: &mut State) {
        state.begin_step();
        self.is_near = state.near_balls().next().is_some();
        self.steps_near += usize::from(self.is_near);
        self.time(|method| method.begin_step(state));
        for runs in &mut self.runs {
            runs.broad[shot].add(&mut runs.times);
        }
    }

    fn substep(&mut self, shot: usize, state: &mut State) {
        if !self.is_near {
            return;
        }
        state.copy_places();
        self.time(|method| {
            method.find(state);
        });
        let exact = ExactContacts::of(state);
        self.states += 1;
        self.contacts += exact.certain.len();
        for runs in &mut self.runs {
            runs.narrow[shot].add(&mut runs.times);
            let method = &mut runs.instances[0];
            runs.queries += method.find(state);
            let errors = exact.errors_of(method.pairs(state));
            runs.missed += errors.missed;
            runs.false_contacts += errors.false_contacts;
        }
    }
}

/// Bombards the curtain and compares all methods on its states. `on_step` gets the time in seconds.
///
/// # Errors
/// [`Failure`] if the solver refuses the scene or a step.
pub fn measure(bombardment: &Bombardment, on_step: impl FnMut(f64)) -> Result<CurtainReport, Failure> {
    let mut comparison = MethodComparison::new(bombardment.shots.len());
    bombardment.run(&mut comparison, on_step)?;
    let MethodComparison { runs, steps_near, states, contacts, .. } = comparison;
    let mut methods: Vec<_> = runs.into_iter().map(MethodRuns::report).collect();
    let of_all = |methods: &[MethodReport]| {
        methods.first().map_or((0.0, 0.0), |ours| {
            (ours.ms_per_shot.iter().sum::<f64>(), ours.least_ms_per_shot.iter().sum())
        })
    };
    let (median, least) = of_all(&methods);
    for method in &mut methods {
        method.ratio_to_ours = method.ms_per_shot.iter().sum::<f64>() / median;
        method.least_ratio_to_ours = method.least_ms_per_shot.iter().sum::<f64>() / least;
    }
    Ok(CurtainReport { particles: bombardment.particles, steps_near, states, contacts, methods })
}

impl MethodRuns {
    fn report(self) -> MethodReport {
        let Self { instances, broad, narrow, queries, missed, false_contacts, .. } = self;
        let per_shot = |of: fn(&Times) -> Duration| -> Vec<f64> {
            let both = broad.iter().zip(&narrow);
            both.map(|(broad, narrow)| (of(broad) + of(narrow)).as_secs_f64() * 1e3).collect()
        };
        let ms_per_shot = per_shot(|times| times.median);
        let broad_ms: f64 = broad.iter().map(|times| times.median.as_secs_f64() * 1e3).sum();
        MethodReport {
            name: instances.first().map_or("", |method| method.name()),
            broad_phase_share: broad_ms / ms_per_shot.iter().sum::<f64>(),
            ms_per_shot,
            least_ms_per_shot: per_shot(|times| times.least),
            ratio_to_ours: 1.0,
            least_ratio_to_ours: 1.0,
            queries,
            missed,
            false_contacts,
        }
    }
}

impl CurtainReport {
    /// The table, as in the paper.
    pub fn table(&self) -> String {
        let mut table = Table::new();
        let shots = self.methods.first().map_or(0, |method| method.ms_per_shot.len());
        let header = std::iter::once("ms of collision detection".to_owned())
            .chain((1..=shots).map(|shot| format!("shot {shot}")))
            .chain(["mean", "ratio", "by least", "broad", "queries", "missed", "false"].map(str::to_owned));
        table.load_preset(presets::UTF8_HORIZONTAL_ONLY).set_header(header);
        for method in &self.methods {
            let shots = &method.ms_per_shot;
            let mean = shots.iter().sum::<f64>() / shots.len().max(1) as f64;
            let row = std::iter::once(method.name.to_owned())
                .chain(shots.iter().chain([&mean]).map(|ms| format!("{ms:.2}")))
                .chain([
                    format!("{:.2}", method.ratio_to_ours),
                    format!("{:.2}", method.least_ratio_to_ours),
                    format!("{:.0} %", method.broad_phase_share * 100.0),
                    method.queries.to_string(),
                    method.missed.to_string(),
                    method.false_contacts.to_string(),
                ]);
            table.add_row(row);
        }
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        let [columns, rows] = self.particles;
        let Self { steps_near, states, contacts, .. } = self;
        format!(
            "curtain of {columns} x {rows} particles: {contacts} contacts in {states} substeps of the {steps_near} steps with a \
             ball near it\n{table}"
        )
    }
}

#[cfg(test)]
mod tests {
    use drape_solver::glam::Vec3;
    use drape_solver::{BallMaterial, BodySettings};

    use super::*;
    use crate::experiments::bombardment::Shot;

    fn small(particles: [u32; 2]) -> Bombardment {
        let shot = |index: u32, x: f32, speed: f32| Shot {
            time: 0.1 + 0.7 * f64::from(index),
            muzzle: Vec3::new(x, 1.0, 2.0),
            velocity: Vec3::new(-0.5 * x, 2.0, -speed),
        };
        Bombardment {
            size: [2.0, 1.5],
            clearance: 0.3,
            particles,
            settings: BodySettings { substeps: 4, ..BodySettings::default() },
            ball: BallMaterial::default(),
            shots: vec![shot(0, 0.0, 8.0), shot(1, 0.4, 25.0)],
            step: 1.0 / 60.0,
            gravity: Vec3::new(0.0, -9.81, 0.0),
            rest: 0.7,
        }
    }

    /// On grids of all layouts: in rows, in square patches, and too small to be cut.
    #[test]
    fn all_methods_find_the_contacts_of_brute_force() {
        for particles in [[40, 30], [17, 13], [5, 4]] {
            let report = measure(&small(particles), |_| {}).expect("the solver takes it");
            assert!(report.contacts > 20, "{} contacts only", report.contacts);
            for method in &report.methods {
                let errors = (method.missed, method.false_contacts);
                // GJK's distances have relative errors of up to a thousandth.
                let allowed = if method.name.contains("GJK") { 1 + report.contacts / 100 } else { 0 };
                assert!(
                    errors.0 <= allowed && errors.1 <= allowed,
                    "{particles:?} {}: {errors:?}",
                    method.name
                );
                assert_eq!(method.ms_per_shot.len(), 2);
            }
        }
    }
}
