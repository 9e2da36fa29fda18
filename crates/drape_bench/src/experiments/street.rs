//! Measures the savings by levels of detail: flags along both sides of a street in the wind, seen from one of its ends.

use std::error::Error;
use std::time::Duration;

use bevy::prelude::{App, Entity, Transform};
use bevy_drape::detail::{CurrentDetail, LevelOfDetail};
use bevy_drape::environment::{Gusts, Wind};
use bevy_drape::prelude::{Cloth, ClothPins, Particles};
use bevy_drape::schedule::StepTimes;
use bevy_drape::sleep::{ActivityCounts, SceneManager};
use bevy_drape::viewer::Viewer;
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::Vec3;

use crate::failure::Failure;
use crate::measure::median::{in_ms, median};
use crate::scenes::world::STEP;
use crate::solvers::plugin;

/// Distance between two flags on one side of the street, and between the sides, in metres.
const SPACING: f32 = 1.0;
const WIDTH: f32 = 10.0;
/// Steps before timing begins.
const WARM_UP: u32 = 180;
/// Speed of a viewer who runs down the street in m/s: fast, so that many flags change their level.
const WALK: f32 = 10.0;

/// Arguments of `street`.
#[derive(Args, Clone, Debug)]
pub struct StreetArguments {
    /// Numbers of flags.
    #[arg(long, value_delimiter = ',', default_values_t = [1000])]
    flags: Vec<u32>,
    /// Particles along a side of a flag.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(4..=256))]
    n: u32,
    /// Threads.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    threads: u32,
    /// Steps that are timed; the medians count.
    #[arg(long, default_value_t = 180, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
}

/// Times of a step in milliseconds.
struct StreetCost {
    median: f64,
    least: f64,
    greatest: f64,
    /// Number of flags at each level, from full detail on.
    levels: Vec<usize>,
    frozen: usize,
    particles: usize,
}

/// Measures all numbers of flags, with and without levels, and prints a table.
///
/// # Errors
/// If the plugin cannot be run on that many threads.
pub fn report(street: &StreetArguments) -> Result<(), Box<dyn Error>> {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header([
        "flags",
        "",
        "step, ms",
        "least",
        "greatest",
        "at levels 0, 1, ...",
        "frozen",
        "particles",
    ]);
    for &flags in &street.flags {
        let mut full = None;
        for (name, has_levels, walk) in
            [("in full", false, 0.0), ("levels", true, 0.0), ("levels, viewer runs by", true, WALK)]
        {
            let StreetCost { median, least, greatest, levels, frozen, particles } =
                measure(street, flags, has_levels, walk)?;
            let part = median / *full.get_or_insert(median);
            table.add_row([
                flags.to_string(),
                name.to_string(),
                format!("{median:.2} ({:.0} %)", part * 100.0),
                format!("{least:.2}"),
                format!("{greatest:.2}"),
                format!("{levels:?}"),
                frozen.to_string(),
                particles.to_string(),
            ]);
        }
    }
    println!("{table}");
    Ok(())
}

fn measure(street: &StreetArguments, flags: u32, has_levels: bool, walk: f32) -> Result<StreetCost, Failure> {
    let mut app = plugin::app(street.threads)?;
    app.world_mut().resource_mut::<SceneManager>().sleeping = false;
    app.insert_resource(Wind {
        gusts: Gusts { speed: 2.0, ..Gusts::default() },
        lift_coefficient: 1.0,
        ..Wind::new(Vec3::new(6.0, 0.0, 1.0))
    });
    let viewer = app.world_mut().spawn((Viewer, Transform::from_xyz(0.0, 2.0, 0.0))).id();
    let bodies: Vec<Entity> = (0..flags).map(|i| spawn(&mut app, street.n, i, has_levels)).collect();
    let mut times: Vec<Duration> = Vec::new();
    for step in 0..WARM_UP + street.steps {
        app.update();
        if step >= WARM_UP {
            times.push(app.world().resource::<StepTimes>().step);
            if let Some(mut place) = app.world_mut().get_mut::<Transform>(viewer)
                && walk > 0.0
            {
                place.translation.z -= walk * STEP;
            }
        }
    }
    let median = median(&mut times);
    let world = app.world();
    let level = |body: &Entity| world.get::<CurrentDetail>(*body).map_or(0, CurrentDetail::level);
    let deepest = bodies.iter().map(level).max().unwrap_or(0);
    Ok(StreetCost {
        median: in_ms(median),
        least: in_ms(times[0]),
        greatest: in_ms(times[times.len() - 1]),
        levels: (0..=deepest).map(|of| bodies.iter().filter(|body| level(body) == of).count()).collect(),
        frozen: world.resource::<ActivityCounts>().frozen,
        particles: bodies
            .iter()
            .filter_map(|&body| world.get::<Particles>(body))
            .map(|body| body.len())
            .sum(),
    })
}

/// Spawns flag `i`: left and right in turns, farther down the street with growing `i`.
fn spawn(app: &mut App, n: u32, i: u32, has_levels: bool) -> Entity {
    let side = if i.is_multiple_of(2) { -0.5 } else { 0.5 };
    let place = Transform::from_xyz(side * WIDTH, 4.0, -SPACING * (i / 2) as f32);
    let flag = Cloth::new(1.5, 1.0).with_particles(n, n).with_pins(ClothPins::Left);
    let mut flag = app.world_mut().spawn((flag, place));
    if has_levels {
        flag.insert(LevelOfDetail::default());
    }
    flag.id()
}
