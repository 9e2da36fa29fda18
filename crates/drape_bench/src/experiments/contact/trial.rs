//! One scene in one mode of self-contact: its cost and its crossings.

use std::time::{Duration, Instant};

use clap::ValueEnum;
use drape_solver::glam::DVec3;
use drape_solver::{BodySettings, Quality, SelfContact, StateHasher, step, step_on};
use serde::Serialize;

use crate::experiments::contact::scene::ContactScene;
use crate::experiments::contact::setup::Setup;
use crate::failure::Failure;
use crate::measure::cpu_time::cpu_time;
use crate::measure::median::in_ms;
use crate::report::table::name_of;
use crate::scenes::world::STEP;
use crate::solvers::threads::{RayonPool, on_threads};

/// Distance in metres that the middle of a cloth or rope keeps: layers are 1 cm apart.
const THICKNESS: f32 = 0.005;
/// Friction of cloth and rope.
const FRICTION: f32 = 0.5;
/// Steps between two that are searched for crossings, unless all are.
const STEPS_BETWEEN: usize = 10;
/// Steps whose speeds make the speed at the end.
const LAST_STEPS: usize = 10;
/// States that wait to be searched for crossings. The search empties the caches, so that many states wait for one.
const MOST_STATES: usize = 64;

/// A mode of self-contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// None: bodies pass through themselves and each other.
    Off,
    /// Between corners, faces, edges and links.
    #[value(alias = "triangles")]
    On,
}

/// A level of accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Accuracy {
    /// 4 substeps.
    Low,
    /// 8 substeps, the default.
    Medium,
    /// 16 substeps, and lines.
    High,
}

impl From<Accuracy> for Quality {
    fn from(accuracy: Accuracy) -> Self {
        match accuracy {
            Accuracy::Low => Self::Low,
            Accuracy::Medium => Self::Medium,
            Accuracy::High => Self::High,
        }
    }
}

/// A run.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// The scene.
    pub scene: ContactScene,
    /// Self-contact of all bodies.
    pub mode: Mode,
    /// Accuracy of all bodies.
    pub quality: Accuracy,
    /// Threads.
    pub threads: u32,
    /// Thickness of all bodies in metres, or none for the usual one.
    pub thickness: Option<f32>,
    /// The number of steps.
    pub steps: usize,
    /// True if every step is searched for crossings, else each tenth and the last.
    pub every_step: bool,
}

/// The measurements of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    /// Name of the scene.
    pub scene: String,
    /// Name of the mode.
    pub mode: String,
    /// Name of the accuracy.
    pub quality: String,
    /// Greatest thickness of a body in metres.
    pub thickness: f32,
    /// Threads.
    pub threads: u32,
    /// Steps.
    pub steps: usize,
    /// Particles of all bodies.
    pub particles: usize,
    /// Triangles of all bodies.
    pub triangles: usize,
    /// Mean wall time of a step in milliseconds.
    pub ms_mean: f64,
    /// Wall time in milliseconds that 99 of 100 steps do not exceed.
    pub ms_p99: f64,
    /// Greatest wall time of a step in milliseconds.
    pub ms_max: f64,
    /// Mean time of the processor in a step in milliseconds, all threads together; none where the system does not tell.
    pub cpu_ms_mean: Option<f64>,
    /// Greatest number of pairs that self-contact watched at the end of a step.
    pub pairs: usize,
    /// Lists of pairs that were made in all steps.
    pub rebuilds: u32,
    /// Times that parts were moved back because they would have passed each other.
    pub truncated: u32,
    /// Substeps in which parts could not be kept from passing each other.
    pub unfinished: u32,
    /// The number of steps that were searched for crossings.
    pub steps_searched: usize,
    /// Greatest number of edges through triangles; none if there are no triangles.
    pub crossings_max: Option<usize>,
    /// Edges through triangles after the last step.
    pub crossings_end: Option<usize>,
    /// Searched steps that ended with crossings.
    pub steps_with_crossings: Option<usize>,
    /// Root mean square speed in m/s of all particles, by their ways from step to step: the mean of the last ten steps.
    pub rms_speed_end: f64,
    /// Hash of the final state in hexadecimal digits.
    pub hash: String,
}

impl Trial {
    /// Settings of all bodies.
    pub fn settings(&self) -> BodySettings {
        let self_contact = match self.mode {
            Mode::Off => SelfContact::Off,
            Mode::On => SelfContact::On,
        };
        let thickness = self.thickness.unwrap_or(THICKNESS);
        let surface = BodySettings { thickness, friction: FRICTION, ..BodySettings::default() };
        BodySettings { self_contact, ..surface.with_quality(self.quality.into()) }
    }

    /// Runs the scene. `stepped` is called after each step.
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses the scene or a step.
    pub fn measure(&self, stepped: impl Fn() + Send) -> Result<Figures, Failure> {
        self.measure_setup(self.scene.setup(self.settings())?, stepped)
    }

    /// Runs another scene under the name of this one.
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses a step.
    pub fn measure_setup(&self, setup: Setup, stepped: impl Fn() + Send) -> Result<Figures, Failure> {
        on_threads(self.threads, || self.run(setup, stepped))?
    }

    /// The run on the present threads.
    fn run(&self, mut setup: Setup, stepped: impl Fn()) -> Result<Figures, Failure> {
        let mut counter = setup.crossing_counter();
        let mut times = Vec::new();
        let mut cpu = CpuClock::started();
        let (mut pairs, mut rebuilds, mut truncated, mut unfinished) = (0, 0, 0, 0);
        let (mut speeds, mut before) = (Vec::new(), setup.positions());
        let (mut states, mut counts) = (Vec::new(), Vec::new());
        for number in 1..=self.steps {
            setup.move_pins(number as f32 * STEP);
            let began = Instant::now();
            if self.threads > 1 {
                step_on(&mut setup.island, &setup.environment, &RayonPool)?;
            } else {
                step(&mut setup.island, &setup.environment)?;
            }
            times.push(began.elapsed());
            let work = setup.island.self_contact_counts();
            pairs = pairs.max(work.pairs);
            rebuilds += work.lists;
            truncated += work.truncated;
            unfinished += work.unfinished;
            let now = setup.positions();
            speeds.push(rms_distance(&before, &now) / f64::from(STEP));
            before = now;
            let is_last = number == self.steps;
            if self.every_step || number % STEPS_BETWEEN == 0 || is_last {
                states.push(before.clone());
            }
            if states.len() == MOST_STATES || is_last {
                cpu.pause();
                counts.extend(states.drain(..).map(|state| counter.count(&state)));
                cpu.go_on();
            }
            stepped();
        }
        let last = &speeds[speeds.len().saturating_sub(LAST_STEPS)..];
        let crossings = (setup.triangle_count() > 0).then_some(counts.as_slice());
        times.sort_unstable();
        let mean = times.iter().sum::<Duration>() / times.len().max(1) as u32;
        let at = |place: usize| times.get(place).copied().map_or(0.0, in_ms);
        Ok(Figures {
            scene: name_of(&self.scene),
            mode: name_of(&self.mode),
            quality: name_of(&self.quality),
            thickness: setup.thickness(),
            threads: self.threads,
            steps: self.steps,
            particles: setup.particle_count(),
            triangles: setup.triangle_count(),
            ms_mean: in_ms(mean),
            ms_p99: at((times.len() * 99).div_ceil(100).saturating_sub(1)),
            ms_max: at(times.len().saturating_sub(1)),
            cpu_ms_mean: cpu.sum.map(|sum| in_ms(sum) / self.steps as f64),
            pairs,
            rebuilds,
            truncated,
            unfinished,
            steps_searched: counts.len(),
            crossings_max: crossings.and_then(|counts| counts.iter().copied().max()),
            crossings_end: crossings.and_then(|counts| counts.last().copied()),
            steps_with_crossings: crossings.map(|counts| counts.iter().filter(|&&count| count > 0).count()),
            rms_speed_end: last.iter().sum::<f64>() / last.len().max(1) as f64,
            hash: hash(&setup),
        })
    }
}

/// Adds up the time of the processor; none where the system does not tell it.
struct CpuClock {
    sum: Option<Duration>,
    since: Option<Duration>,
}

impl CpuClock {
    fn started() -> Self {
        Self { sum: Some(Duration::ZERO), since: cpu_time() }
    }

    fn pause(&mut self) {
        let more = cpu_time().zip(self.since).map(|(now, since)| now.saturating_sub(since));
        self.sum = self.sum.zip(more).map(|(sum, more)| sum + more);
    }

    fn go_on(&mut self) {
        self.since = cpu_time();
    }
}

/// Root mean square distance of two states in metres.
fn rms_distance(before: &[DVec3], now: &[DVec3]) -> f64 {
    let squares = before.iter().zip(now).map(|(a, b)| a.distance_squared(*b));
    (squares.sum::<f64>() / now.len() as f64).sqrt()
}

fn hash(setup: &Setup) -> String {
    let mut hasher = StateHasher::new();
    for body in &setup.island.bodies {
        hasher.particles(&body.particles);
    }
    format!("{:016x}", hasher.finish())
}

#[cfg(test)]
mod tests {
    use drape_solver::Obstacles;
    use drape_solver::glam::Vec3;

    use super::*;
    use crate::experiments::contact::cloths;

    const TINY: Trial = Trial {
        scene: ContactScene::Fold20,
        mode: Mode::On,
        quality: Accuracy::Medium,
        thickness: Some(THICKNESS),
        threads: 1,
        steps: 3,
        every_step: false,
    };

    fn tiny(trial: Trial) -> serde_json::Value {
        let setup = cloths::fold(3, 12, trial.settings()).expect("valid");
        serde_json::to_value(trial.measure_setup(setup, || {}).expect("finite")).expect("plain data")
    }

    #[test]
    fn a_tiny_run_writes_every_figure() {
        let json = tiny(TINY);
        let text = |field: &str| json[field].as_str().expect("text").to_owned();
        let [scene, mode, quality] = ["scene", "mode", "quality"].map(text);
        assert_eq!([&scene, &mode, &quality], ["fold20", "on", "medium"]);
        let figures =
            [("threads", 1), ("steps", 3), ("particles", 36), ("triangles", 44), ("steps_searched", 1)];
        for (field, figure) in figures {
            assert_eq!(json[field], figure, "{field}");
        }
        let number = |field: &str| json[field].as_f64().expect("a number");
        assert!(number("ms_mean") <= number("ms_max") && number("ms_p99") <= number("ms_max"), "{json}");
        assert!(number("ms_mean") > 0.0, "{json}");
        // After three steps of free fall it falls at up to 0.5 m/s.
        assert!((0.1..0.6).contains(&number("rms_speed_end")), "{json}");
        for field in ["crossings_max", "crossings_end", "steps_with_crossings"] {
            assert_eq!(json[field], 0, "{field}");
        }
        assert_eq!(json["truncated"], 0, "{json}");
        assert_eq!(text("hash").len(), 16);
    }

    #[test]
    fn bodies_are_as_thick_as_asked_for() {
        let thickness = |trial: Trial| tiny(trial)["thickness"].as_f64().expect("metres") as f32;
        assert_eq!(thickness(Trial { thickness: None, ..TINY }), THICKNESS);
        assert_eq!(thickness(Trial { thickness: Some(0.004), ..TINY }), 0.004);
    }

    #[test]
    fn the_same_run_ends_in_the_same_bits_on_any_number_of_threads() {
        let hash = |trial: Trial| tiny(trial)["hash"].clone();
        assert_eq!(hash(TINY), hash(Trial { threads: 2, every_step: true, ..TINY }));
        assert_ne!(hash(TINY), hash(Trial { steps: 4, ..TINY }));
    }

    #[test]
    fn every_step_each_tenth_and_the_last_are_searched() {
        let searched =
            |steps, every_step| tiny(Trial { steps, every_step, ..TINY })["steps_searched"].clone();
        assert_eq!(searched(25, false), 3);
        assert_eq!(searched(20, false), 2);
        assert_eq!(searched(100, true), 100);
    }

    #[test]
    fn a_sheet_that_falls_through_another_is_seen_to_cross_it() {
        let trial = Trial { mode: Mode::Off, steps: 30, every_step: true, ..TINY };
        let mut setup = cloths::stack(3, 8, trial.settings()).expect("valid");
        setup.environment.obstacles = Obstacles::new();
        // The topmost falls faster, and aslant.
        for i in 0..64 {
            let speed = 0.3 + 0.05 * (i % 8) as f32;
            setup.island.bodies[2].particles.set_velocity(i, Vec3::NEG_Y * speed);
        }
        let figures = trial.measure_setup(setup, || {}).expect("finite");
        let [most, end, steps] = [figures.crossings_max, figures.crossings_end, figures.steps_with_crossings]
            .map(Option::unwrap_or_default);
        assert!(most > 10, "{figures:?}");
        assert_eq!(end, 0, "{figures:?}");
        assert!((1..30).contains(&steps), "{figures:?}");
    }

    #[test]
    fn every_scene_begins_apart_and_takes_a_step() {
        for &scene in ContactScene::value_variants() {
            let trial = Trial { scene, mode: Mode::Off, steps: 1, ..TINY };
            let setup = scene.setup(trial.settings()).expect("valid");
            assert_eq!(setup.crossing_counter().count(&setup.positions()), 0, "{scene:?}");
            let particles = setup.particle_count();
            let figures = trial.measure(|| {}).expect("finite");
            assert_eq!(
                (figures.particles, figures.crossings_end.is_none()),
                (particles, scene == ContactScene::Bowline)
            );
            let mut bare = scene.setup(trial.settings()).expect("valid");
            bare.environment.obstacles = Obstacles::new();
            let without = trial.measure_setup(bare, || {}).expect("finite");
            assert_eq!(figures.hash, without.hash, "{scene:?} begins at an obstacle");
        }
    }
}
