//! Measures rollback: flags that go back some frames in each frame, and come forward again.

use std::collections::VecDeque;
use std::error::Error;
use std::time::{Duration, Instant};

use bevy::prelude::{App, Transform};
use bevy_drape::environment::{Gusts, Wind};
use bevy_drape::prelude::{Cloth, ClothPins};
use bevy_drape::sleep::SceneManager;
use bevy_drape::snapshot::Snapshot;
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::Vec3;

use crate::measure::median::{in_ms, median};
use crate::solvers::plugin;

/// Steps before timing begins.
const WARM_UP: usize = 60;
/// Distance between two flags in metres: none touches another.
const SPACING: f32 = 4.0;

/// Arguments of `rollback`.
#[derive(Args, Clone, Debug)]
pub struct RollbackArguments {
    /// Numbers of flags.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 10, 100])]
    cloths: Vec<u16>,
    /// Particles along a side of a flag.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(4..=256))]
    n: u32,
    /// Frames that are taken back in each frame.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=64))]
    back: u32,
    /// Threads.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    threads: u32,
    /// Frames that are timed; the medians count.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
}

/// Times of each frame.
#[derive(Default)]
struct Times {
    save: Vec<Duration>,
    restore: Vec<Duration>,
    step: Vec<Duration>,
    frame: Vec<Duration>,
}

/// Measures all numbers of flags and prints a table.
///
/// # Errors
/// If the plugin cannot be run on that many threads, or a snapshot cannot be restored.
pub fn report(rollback: &RollbackArguments) -> Result<(), Box<dyn Error>> {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header(["flags", "bytes", "save, ms", "restore, ms", "step, ms", "frame, ms", "frame, steps"]);
    for &cloths in &rollback.cloths {
        let mut app = world(rollback, cloths)?;
        let bytes = postcard::to_stdvec(&Snapshot::take(app.world_mut()))?.len();
        let mut times = measure(&mut app, rollback)?;
        let [save, restore, step, frame] =
            [&mut times.save, &mut times.restore, &mut times.step, &mut times.frame]
                .map(|times| in_ms(median(times)));
        table.add_row([
            cloths.to_string(),
            bytes.to_string(),
            format!("{save:.3}"),
            format!("{restore:.3}"),
            format!("{step:.3}"),
            format!("{frame:.3}"),
            format!("{:.2}", frame / step),
        ]);
    }
    println!("{table}");
    Ok(())
}

/// Flags in gusts.
fn world(rollback: &RollbackArguments, cloths: u16) -> Result<App, Box<dyn Error>> {
    let mut app = plugin::app(rollback.threads)?;
    app.world_mut().resource_mut::<SceneManager>().sleeping = false;
    app.insert_resource(Wind {
        gusts: Gusts { speed: 2.0, ..Gusts::default() },
        ..Wind::new(Vec3::new(6.0, 0.0, 1.0))
    });
    for i in 0..cloths {
        let flag = Cloth::new(1.5, 1.0).with_particles(rollback.n, rollback.n).with_pins(ClothPins::Left);
        app.world_mut().spawn((flag, Transform::from_xyz(0.0, 4.0, -SPACING * f32::from(i))));
    }
    for _ in 0..WARM_UP {
        app.update();
    }
    Ok(app)
}

/// Goes back in each frame, and takes the same steps and one more. Saves before each step, as libraries for rollback do.
fn measure(app: &mut App, rollback: &RollbackArguments) -> Result<Times, Box<dyn Error>> {
    let back = rollback.back as usize;
    let mut times = Times::default();
    let mut saved = VecDeque::new();
    for _ in 0..back {
        saved.push_back(Snapshot::take(app.world_mut()));
        app.update();
    }
    for _ in 0..rollback.frames {
        let frame = Instant::now();
        if let Some(then) = saved.pop_front() {
            then.restore(app.world_mut())?;
            times.restore.push(frame.elapsed());
        }
        saved.clear();
        for step in 0..=back {
            let start = Instant::now();
            let snapshot = Snapshot::take(app.world_mut());
            let between = Instant::now();
            app.update();
            times.save.push(between - start);
            times.step.push(between.elapsed());
            if step > 0 {
                saved.push_back(snapshot);
            }
        }
        times.frame.push(frame.elapsed());
    }
    Ok(times)
}
