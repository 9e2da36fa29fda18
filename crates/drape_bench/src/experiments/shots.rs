//! Checks that no ball passes through a curtain.
//!
//! Each shot is drawn at random, by its index and the seed alone: a ball of 2 kg, its radius, speed and direction, the
//! point of the curtain that it is aimed at, the resolution of the curtain and its pins. An [`Oracle`] follows the
//! ball's centre through every substep. Balls may go round the curtain's edge; a shot fails if the centre is ever on
//! the other side of the cloth.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::{DVec3, Vec3};
use drape_solver::step::{accumulate_forces, begin, detect_collisions, finish, substep};
use drape_solver::{Ball, BallMaterial, BodySettings, ClothBuilder, Environment, Island};
use indicatif::{ParallelProgressIterator, ProgressBar};
use rayon::prelude::*;
use serde::Serialize;

use crate::experiments::oracle::{Oracle, Passages};
use crate::failure::Failure;
use crate::random::Random;
use crate::report::table::write_json;
use crate::scenes::world::{GRAVITY, STEP};

/// Width and height of the curtain, in metres; it hangs in the XY plane about the world's origin.
const SIZE: [f32; 2] = [4.0, 3.0];
/// Least gap between ball and curtain at the start, in metres.
const GAP: f32 = 0.1;
/// Least cosine of the angle between a shot and the curtain's normal: 84 degrees aslant.
const MOST_ASLANT: f64 = 0.1;
/// Duration of a shot after the ball reaches the curtain, in seconds.
const TIME: f32 = 1.0;

/// Arguments of `shots`.
#[derive(Args, Clone, Debug)]
pub struct ShotArguments {
    /// Number of shots.
    #[arg(long, default_value_t = 10_000)]
    count: u64,
    /// Seed of the shots.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Fires only the shot of this index.
    #[arg(long, value_name = "INDEX")]
    only: Option<u64>,
    /// Also write the results as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Pinned particles of the top row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
enum Pinned {
    /// The corners.
    Two,
    /// Four, evenly spread.
    Four,
    /// All.
    All,
}

/// A ball and a curtain.
#[derive(Clone, Debug, Serialize)]
pub struct RandomShot {
    seed: u64,
    index: u64,
    /// Particles in a row and in a column.
    columns: u32,
    rows: u32,
    pinned: Pinned,
    /// Radius of the ball in metres.
    radius: f32,
    /// Speed in m/s.
    speed: f32,
    /// Direction of flight, a unit vector.
    direction: [f32; 3],
    /// Target point of the curtain in metres.
    target: [f32; 3],
}

/// A shot and its result.
#[derive(Clone, Debug, Serialize)]
pub struct ShotResult {
    #[serde(flatten)]
    shot: RandomShot,
    /// True if the ball's centre has been on the other side of the cloth.
    is_wrong: bool,
    /// When it was there first, in seconds from the start.
    wrong_after: Option<f32>,
    /// Greatest number of substeps of a step.
    substeps: u32,
}

/// The results of all shots, for JSON.
#[derive(Serialize)]
struct ShotReport<'a> {
    shots: usize,
    wrong_side: usize,
    /// The slowest of the balls that passed through, or else the fastest of all.
    worst_case: Option<&'a ShotResult>,
}

impl RandomShot {
    /// The shot of this index among those of the seed.
    pub fn draw(seed: u64, index: u64) -> Self {
        let mut random = Random::of_index(seed, index);
        // As many coarse curtains as fine ones, and as many slow balls as fast ones: evenly spread logarithms.
        let quarters = (4.0 * random.between(0.0, 3.0).exp2()).round() as u32;
        let speed = 5.0 * 40.0_f64.powf(random.between(0.0, 1.0));
        let radius = random.between(0.03, 0.5);
        let pins = [Pinned::Two, Pinned::Four, Pinned::All];
        let pinned = pins[(random.between(0.0, 3.0) as usize).min(2)];
        let direction = loop {
            let [x, y, z] = [(); 3].map(|()| random.either_side());
            let length = (x * x + y * y + z * z).sqrt();
            if (0.1..=1.0).contains(&length) && z.abs() >= MOST_ASLANT * length {
                break DVec3::new(x, y, z) / length;
            }
        };
        let [across, up] = SIZE.map(|side| (0.5 * f64::from(side) * random.either_side()) as f32);
        Self {
            seed,
            index,
            columns: 4 * quarters,
            rows: 3 * quarters,
            pinned,
            radius: radius as f32,
            speed: speed as f32,
            direction: direction.as_vec3().to_array(),
            target: [across, up, 0.0],
        }
    }

    /// Spacing of the particles, in metres.
    fn spacing(&self) -> f32 {
        SIZE[0] / (self.columns - 1) as f32
    }

    fn island(&self) -> Result<Island, Failure> {
        let &Self { columns, rows, pinned, .. } = self;
        let is_pinned = |column: u32, row: u32| {
            let is_one = match pinned {
                Pinned::Two => column == 0 || column + 1 == columns,
                Pinned::Four => (0..4).any(|i| column == i * (columns - 1) / 3),
                Pinned::All => true,
            };
            row == 0 && is_one
        };
        let corner = Vec3::new(-0.5 * SIZE[0], 0.5 * SIZE[1], 0.0);
        let curtain = ClothBuilder::new(SIZE[0], SIZE[1], columns, rows)
            .placed(corner, Vec3::X, Vec3::NEG_Y)
            .pin_where(|column, row, _| is_pinned(column, row));
        let mut island = Island::of_body(curtain.build(BodySettings::default())?);
        let material = BallMaterial { radius: self.radius, mass: 2.0, ..BallMaterial::default() };
        let direction = Vec3::from(self.direction);
        let start = Vec3::from(self.target) - direction * self.distance();
        island.balls.push(Ball::new(material, start, direction * self.speed)?);
        Ok(island)
    }

    /// Distance of the ball's centre from the target at the start, in metres.
    fn distance(&self) -> f32 {
        (self.radius + GAP) / self.direction[2].abs()
    }

    /// Fires the shot.
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses the curtain or a step.
    pub fn fire(self) -> Result<ShotResult, Failure> {
        let mut island = self.island()?;
        let environment = Environment { dt: STEP, gravity: GRAVITY, ..Environment::default() };
        let steps = ((self.distance() / self.speed + TIME) / STEP).ceil() as usize;
        let faces = island.bodies[0].topology.faces().to_vec();
        let mut oracle = Oracle::new(&faces, relative_particles(&island));
        let (mut net, mut most_substeps) = (0, 0);
        for index in 0..steps {
            begin(&mut island, &environment)?;
            accumulate_forces(&mut island, &environment);
            detect_collisions(&mut island, &environment);
            let substeps = island.substeps();
            most_substeps = most_substeps.max(substeps);
            for place in 1..=substeps {
                substep(&mut island, &environment);
                let Passages { net: more, .. } = oracle.advance(relative_particles(&island));
                net += more;
                if net != 0 {
                    let after = (index as f32 + place as f32 / substeps as f32) * STEP;
                    return Ok(self.result(Some(after), most_substeps));
                }
            }
            finish(&mut island)?;
        }
        Ok(self.result(None, most_substeps))
    }

    fn result(self, wrong_after: Option<f32>, substeps: u32) -> ShotResult {
        ShotResult { shot: self, is_wrong: wrong_after.is_some(), wrong_after, substeps }
    }
}

/// Positions of the curtain's particles relative to the ball's centre, in metres.
fn relative_particles(island: &Island) -> impl Iterator<Item = DVec3> {
    let particles = &island.bodies[0].particles;
    let origin = particles.origin().as_dvec3() - island.balls[0].position().as_dvec3();
    (0..particles.len()).map(move |i| origin + particles.local_position(i).as_dvec3())
}

/// Fires the shots on all cores, and prints how many passed through by speed, radius, pins and resolution.
///
/// # Errors
/// If the solver refuses a shot, or the file cannot be written; [`Failure::Passed`] if any ball passed through.
pub fn report(range: &ShotArguments) -> Result<(), Box<dyn Error>> {
    let indices = range.only.map_or(0..range.count, |index| index..index + 1);
    let indices: Vec<u64> = indices.collect();
    let progress = ProgressBar::new(indices.len() as u64);
    let shots =
        indices.par_iter().progress_with(progress).map(|&index| RandomShot::draw(range.seed, index).fire());
    let shots: Vec<ShotResult> = shots.collect::<Result<_, _>>()?;
    print_table(&shots);
    let slowest = |a: &&ShotResult, b: &&ShotResult| a.shot.speed.total_cmp(&b.shot.speed);
    let wrong = || shots.iter().filter(|result| result.is_wrong);
    let worst_case = wrong().min_by(slowest).or_else(|| shots.iter().max_by(slowest));
    let report = ShotReport { shots: shots.len(), wrong_side: wrong().count(), worst_case };
    println!("{} of {} balls passed through the cloth", report.wrong_side, report.shots);
    if let Some(worst) = report.worst_case {
        println!("worst: {}", serde_json::to_string(worst)?);
    }
    if let Some(path) = &range.json {
        write_json(path, &report)?;
    }
    match report.wrong_side {
        0 => Ok(()),
        passed => Err(Failure::Passed { passed, shots: report.shots }.into()),
    }
}

/// A property of shots, and the bounds of its classes.
type Property<'a> = (&'a str, &'a dyn Fn(&RandomShot) -> f32, &'a [f32]);

fn print_table(shots: &[ShotResult]) {
    let aslant = |shot: &RandomShot| shot.direction[2].abs().acos().to_degrees();
    let properties: [Property; 6] = [
        ("speed, m/s", &|shot| shot.speed, &[5.0, 10.0, 20.0, 40.0, 80.0, 120.0, 200.0]),
        ("radius, m", &|shot| shot.radius, &[0.03, 0.06, 0.1, 0.2, 0.35, 0.5]),
        ("radius / spacing", &|shot| shot.radius / shot.spacing(), &[0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 16.0]),
        ("angle, degrees", &aslant, &[0.0, 30.0, 60.0, 90.0]),
        ("columns", &|shot| shot.columns as f32, &[16.0, 24.0, 48.0, 96.0, 129.0]),
        ("pinned (2, 4, all)", &|shot| f32::from(shot.pinned as u8), &[0.0, 1.0, 2.0, 3.0]),
    ];
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED).set_header(["", "from", "to", "shots", "passed through"]);
    for (name, property, bounds) in properties {
        for pair in bounds.windows(2) {
            let class = || shots.iter().filter(|result| (pair[0]..pair[1]).contains(&property(&result.shot)));
            let wrong = class().filter(|result| result.is_wrong).count();
            let figures =
                [pair[0].to_string(), pair[1].to_string(), class().count().to_string(), wrong.to_string()];
            table.add_row(std::iter::once(name.to_owned()).chain(figures));
        }
    }
    println!("{table}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shot_is_the_same_whichever_others_are_taken() {
        let [one, again] = [(); 2].map(|()| RandomShot::draw(1, 7).fire().expect("finite"));
        let text = |result: &ShotResult| serde_json::to_string(result).expect("plain data");
        assert_eq!(text(&one), text(&again));
        assert_ne!(text(&one), text(&RandomShot::draw(2, 7).fire().expect("finite")));
    }

    #[test]
    fn shots_fill_their_ranges() {
        let shots: Vec<RandomShot> = (0..2000).map(|index| RandomShot::draw(3, index)).collect();
        let range = |of: &dyn Fn(&RandomShot) -> f32| {
            let values = shots.iter().map(of);
            [values.clone().fold(f32::INFINITY, f32::min), values.fold(0.0, f32::max)]
        };
        assert_eq!(range(&|shot| shot.columns as f32), [16.0, 128.0]);
        let [least, greatest] = range(&|shot| shot.speed);
        assert!(least < 5.1 && greatest > 196.0 && least >= 5.0 && greatest <= 200.0, "{least} {greatest}");
        let [least, greatest] = range(&|shot| shot.radius);
        assert!(least < 0.035 && greatest > 0.495, "{least} {greatest}");
        for pinned in [Pinned::Two, Pinned::Four, Pinned::All] {
            assert!(shots.iter().filter(|shot| shot.pinned == pinned).count() > 500);
        }
    }

    /// A ball that the solver does not know to touch the curtain is seen to pass through it.
    #[test]
    fn a_ball_that_is_put_behind_the_curtain_is_seen_to_pass() {
        let island = RandomShot::draw(1, 0).island().expect("valid");
        let mut oracle = Oracle::new(island.bodies[0].topology.faces(), relative_particles(&island));
        let mut behind = island.clone();
        let start = island.balls[0].position();
        let target = Vec3::new(0.3, 0.2, 0.0);
        behind.balls[0].set_position(target + (target - start));
        let direction = (target - start).z.signum() as i32;
        assert_eq!(oracle.advance(relative_particles(&behind)), Passages { net: direction, count: 1 });
        assert_eq!(oracle.advance(relative_particles(&island)).net, -direction);
    }
}
