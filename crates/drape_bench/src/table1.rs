//! Table 1 of the founding paper (Liu Yuan 2019), re-run: milliseconds of collision detection per shot by five methods.
//!
//! The curtain is bombarded once, by the solver. All methods look at each state one after the other, each time in another
//! order, so that a noisy machine is noisy for all of them and none finds its data always cold or always warm. Each method
//! is there several times, and each of these keeps its own caches: what counts is the median of their times for
//! a state, and besides it the least. The places of particles and balls are given to each in the form that it wants, for
//! nothing; a method's own structures are built, refitted and asked on its time. Steps of which no ball can come near the cloth
//! cost each method its broad phase only.
//!
//! In each substep the states are those after free flight, where contacts are as deep as they get. A solver asks again
//! after each iteration; that would multiply all narrow phases by the same number.

use std::time::{Duration, Instant};

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;

use crate::bombardment::{Bombardment, Observer};
use crate::collision::brute_force::Truth;
use crate::collision::{Method, State, all};
use crate::contender::Failure;

/// How many of each method there are.
const REPEATS: usize = 5;

/// One method's figures.
#[derive(Clone, Debug, Serialize)]
pub struct MethodReport {
    /// What it is called.
    pub name: &'static str,
    /// Collision detection of each shot, in milliseconds: sums of medians.
    pub ms_per_shot: Vec<f64>,
    /// The same, sums of the least.
    pub least_ms_per_shot: Vec<f64>,
    /// Its time for all shots over that of the first method.
    pub ratio_to_ours: f64,
    /// The same, of the least.
    pub least_ratio_to_ours: f64,
    /// Part of its time that goes to the broad phase.
    pub broad_phase_share: f64,
    /// Faces that were asked for their nearest point, in all.
    pub queries: usize,
    /// Contacts that it should have found.
    pub missed: usize,
    /// Contacts that it should not have found.
    pub false_contacts: usize,
}

/// All methods on one curtain.
#[derive(Clone, Debug, Serialize)]
pub struct CurtainReport {
    /// Particles in a row and in a column.
    pub particles: [u32; 2],
    /// Steps in which a ball could meet the cloth.
    pub steps_near: usize,
    /// Substeps in them: how often contacts were asked for.
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
        times.sort_unstable();
        self.median += times[times.len() / 2];
        self.least += times[0];
    }
}

/// A method, several times over, and what it has done.
struct Contestant {
    instances: Vec<Box<dyn Method>>,
    /// Times of the instances for the state at hand.
    times: Vec<Duration>,
    broad: Vec<Times>,
    narrow: Vec<Times>,
    queries: usize,
    missed: usize,
    false_contacts: usize,
}

/// Lets all methods look at the states of a bombardment.
struct Contest {
    contestants: Vec<Contestant>,
    /// Turns on with every state: who is first.
    turn: usize,
    /// What reading the clock takes.
    clock: Duration,
    is_near: bool,
    steps_near: usize,
    states: usize,
    contacts: usize,
}

impl Contest {
    fn new(shots: usize) -> Self {
        let mut instances: Vec<_> = (0..REPEATS).map(|_| all().into_iter()).collect();
        let mut contestants = Vec::new();
        loop {
            let instances: Vec<_> = instances.iter_mut().filter_map(Iterator::next).collect();
            if instances.is_empty() {
                break;
            }
            contestants.push(Contestant {
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
        Self { contestants, turn: 0, clock, is_near: false, steps_near: 0, states: 0, contacts: 0 }
    }

    /// Lets every instance of every method do `work`, in turns.
    fn time(&mut self, mut work: impl FnMut(&mut dyn Method)) {
        self.contestants.iter_mut().for_each(|contestant| contestant.times.clear());
        let count = self.contestants.len();
        for instance in 0..REPEATS {
            self.turn += 1;
            for place in 0..count {
                let contestant = &mut self.contestants[(place + self.turn) % count];
                let method = &mut *contestant.instances[instance];
                let start = Instant::now();
                work(method);
                let taken = start.elapsed();
                contestant.times.push(taken.saturating_sub(self.clock));
            }
        }
    }
}

impl Observer for Contest {
    fn begin_step(&mut self, shot: usize, state: &mut State) {
        state.begin_step();
        self.is_near = state.near_balls().next().is_some();
        self.steps_near += usize::from(self.is_near);
        self.time(|method| method.begin_step(state));
        for contestant in &mut self.contestants {
            contestant.broad[shot].add(&mut contestant.times);
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
        let truth = Truth::of(state);
        self.states += 1;
        self.contacts += truth.certain.len();
        for contestant in &mut self.contestants {
            contestant.narrow[shot].add(&mut contestant.times);
            let method = &mut contestant.instances[0];
            contestant.queries += method.find(state);
            let faults = truth.judge(method.pairs(state));
            contestant.missed += faults.missed;
            contestant.false_contacts += faults.false_contacts;
        }
    }
}

/// Bombards the curtain under the eyes of all methods. `on_step` is told the time.
///
/// # Errors
/// [`Failure`] if the solver refuses the scene or a step.
pub fn measure(bombardment: &Bombardment, on_step: impl FnMut(f64)) -> Result<CurtainReport, Failure> {
    let mut contest = Contest::new(bombardment.shots.len());
    bombardment.run(&mut contest, on_step)?;
    let Contest { contestants, steps_near, states, contacts, .. } = contest;
    let mut methods: Vec<_> = contestants.into_iter().map(Contestant::report).collect();
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

impl Contestant {
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
    use drape_solver::{BallMaterial, SolverSettings};

    use super::*;
    use crate::bombardment::Shot;

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
            settings: SolverSettings { substeps: 4, ..SolverSettings::default() },
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
                let faults = (method.missed, method.false_contacts);
                // GJK's distances are rough to a part in a thousand.
                let allowed = if method.name.contains("GJK") { 1 + report.contacts / 100 } else { 0 };
                assert!(
                    faults.0 <= allowed && faults.1 <= allowed,
                    "{particles:?} {}: {faults:?}",
                    method.name
                );
                assert_eq!(method.ms_per_shot.len(), 2);
            }
        }
    }
}
