//! The cost of tears and cuts: steps of torn cloth beside those of a whole one, and the tearing itself.

use std::error::Error;
use std::time::Instant;

use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::Vec3;
use drape_solver::{
    Body, BuildError, ClothBuilder, Environment, Island, Quality, StepError, TearLimits, Torn, step,
};

use crate::experiments::contact::trial::Accuracy;
use crate::measure::median::{in_turns, median_us};

/// Steps before the cuts are made.
const SETTLING: u32 = 60;

/// Number of times that each tear is timed.
const TIMED: u32 = 15;

/// Arguments of `torn`.
#[derive(Args, Clone, Debug)]
pub struct TornArguments {
    /// Particles along a side of the cloth.
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(16..=1024))]
    n: u32,
    /// Number of timed steps of each; the medians count.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    repeat: u32,
    /// Accuracy of the cloth.
    #[arg(long, value_enum, default_value_t = Accuracy::Medium)]
    quality: Accuracy,
}

/// A way to tear a cloth of 1 m x 1 m that hangs by its upper corners from (0, 0, 0) and (1, 0, 0).
type Tear = fn(&mut Body) -> Result<Vec<Body>, BuildError>;

const TEARS: [(&str, Tear); 7] = [
    ("whole", |_| Ok(Vec::new())),
    ("a tear in the middle", |body| {
        let middle = body.particles.len() / 2 + 4;
        for particle in middle..middle + 3 {
            let place = body.particles.position(particle);
            body.particles.set_position(particle, place + Vec3::Y * 0.02);
        }
        Ok(bodies(body.tear(&TearLimits::default())?))
    }),
    ("a slit of a tenth of the side", |body| {
        cut(body, Vec3::new(0.4, -0.4, 0.0), Vec3::new(0.47, -0.47, 0.0))
    }),
    ("a cut from the edge to the middle", |body| {
        cut(body, Vec3::new(0.5, -2.0, 0.0), Vec3::new(0.5, -0.5, 0.0))
    }),
    ("a slanting one as long", |body| cut(body, Vec3::new(1.2, -0.8, 0.0), Vec3::new(0.4, -0.4, 0.0))),
    ("32 slits of a tenth of the side", |body| {
        let mut off = Vec::new();
        for i in 0..32_u8 {
            let (column, row) = (f32::from(i % 8), f32::from(i / 8));
            let from = Vec3::new(0.05 + 0.115 * column, -0.2 - 0.2 * row, 0.0);
            off.extend(cut(body, from, from + Vec3::new(0.07, -0.07, 0.0))?);
        }
        Ok(off)
    }),
    ("cut in two, both pieces", |body| cut(body, Vec3::new(-1.0, -0.5, 0.0), Vec3::new(2.0, -0.5, 0.0))),
];

/// Measures all cases, and prints a table.
///
/// # Errors
/// If the cloth cannot be made, cut or stepped.
pub fn report(cuts: &TornArguments) -> Result<(), Box<dyn Error>> {
    let environment = Environment::default();
    let mut start = Island::of_body(curtain(cuts)?);
    (0..SETTLING).try_for_each(|_| step(&mut start, &environment))?;
    let mut islands = Vec::new();
    let mut tearing = Vec::new();
    for (_, tear) in TEARS {
        let mut times = Vec::new();
        let mut torn = start.clone();
        for _ in 0..TIMED {
            let mut island = start.clone();
            let began = Instant::now();
            let pieces = tear(&mut island.bodies[0])?;
            times.push(began.elapsed());
            island.bodies.extend(pieces);
            torn = island;
        }
        tearing.push(median_us(times) * 1e-3);
        islands.push(torn);
    }
    let split: Vec<usize> = islands
        .iter()
        .map(|island| {
            island.bodies.iter().map(|body| body.particles.len()).sum::<usize>() - (cuts.n * cuts.n) as usize
        })
        .collect();
    let bodies: Vec<usize> = islands.iter().map(|island| island.bodies.len()).collect();
    let checks = checks(&mut start.bodies[0], cuts.repeat)?;
    let times = medians(&mut islands, &environment, cuts.repeat)?;
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header(["cloth", "bodies", "split", "tearing, ms", "step, us", "of the whole one's"]);
    for (place, (name, _)) in TEARS.iter().enumerate() {
        table.add_row([
            (*name).to_string(),
            bodies[place].to_string(),
            split[place].to_string(),
            format!("{:.1}", tearing[place]),
            format!("{:.0}", times[place]),
            format!("{:.2}", times[place] / times[0]),
        ]);
    }
    println!("{table}\nto see that nothing tears: {checks:.1} us");
    Ok(())
}

fn curtain(&TornArguments { n, quality, .. }: &TornArguments) -> Result<Body, BuildError> {
    let cloth = ClothBuilder::new(1.0, 1.0, n, n)
        .pin_where(|column, row, _| row == 0 && (column == 0 || column + 1 == n));
    cloth.build(Quality::from(quality).into())
}

fn cut(body: &mut Body, from: Vec3, to: Vec3) -> Result<Vec<Body>, BuildError> {
    let wide = Vec3::Z * 3.0;
    let torn = body.cut(&[[from - wide, to - wide, to + wide], [from - wide, to + wide, from + wide]])?;
    Ok(bodies(torn))
}

/// The bodies that have come off.
fn bodies(torn: Option<Torn>) -> Vec<Body> {
    torn.into_iter().flat_map(|torn| torn.pieces).map(|piece| piece.body).collect()
}

/// Median time in microseconds of checking a body in which nothing tears.
fn checks(body: &mut Body, repeat: u32) -> Result<f64, BuildError> {
    let mut times = Vec::new();
    for _ in 0..repeat {
        let began = Instant::now();
        body.tear(&TearLimits { strain: 10.0, ..TearLimits::default() })?;
        times.push(began.elapsed());
    }
    Ok(median_us(times))
}

/// Median times of a step of each island, in microseconds, taken in turns.
fn medians(islands: &mut [Island], environment: &Environment, repeat: u32) -> Result<Vec<f64>, StepError> {
    Ok(in_turns(islands, environment, repeat)?.into_iter().map(median_us).collect())
}
