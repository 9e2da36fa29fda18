//! Measures a whole frame with cloth: the step, the meshes that the plugin writes, and what Bevy's renderer does with them.
//!
//! ```text
//!   main world:    step | record | write | all else        render world:  extract | prepare and upload
//! ```
//!
//! No camera looks: nothing is drawn, but all meshes go to the graphics device. The same frames with the simulation paused tell what Bevy
//! takes anyway. Without a graphics adapter the renderer's part is missing.

use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use bevy::app::{PluginGroup, PluginsState, TaskPoolOptions, TaskPoolPlugin, TaskPoolThreadAssignmentPolicy};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::{App, Assets, Color, DefaultPlugins, Time, Transform};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::renderer::RenderDevice;
use bevy::render::{RenderApp, RenderPlugin};
use bevy::time::{Fixed, TimeUpdateStrategy};
use bevy_drape::clock::DrapeClock;
use bevy_drape::environment::{Gusts, Wind};
use bevy_drape::prelude::{Cloth, ClothPins, DrapePlugins};
use bevy_drape::render::MeshTimes;
use bevy_drape::schedule::StepTimes;
use bevy_drape::sleep::SceneManager;
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::Vec3;
use serde::Serialize;

use crate::measure::median::{in_ms, median};
use crate::report::table::write_json;
use crate::scenes::world::STEP;

/// Frames before timing begins.
const WARM_UP: usize = 60;
/// Distance between two cloths in metres: none touches another.
const SPACING: f32 = 4.0;

/// Arguments of `frame`.
#[derive(Args, Clone, Debug)]
pub struct FrameArguments {
    /// Numbers of cloths.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 10, 100, 1000])]
    cloths: Vec<u16>,
    /// Particles along a side of a cloth, for each of these numbers.
    #[arg(long, value_delimiter = ',', default_values_t = [64, 64, 64, 16], value_parser = clap::value_parser!(u32).range(2..=1024))]
    sizes: Vec<u32>,
    /// No wind blows.
    #[arg(long)]
    still: bool,
    /// Threads for all of Bevy's tasks, and as many for its renderer's.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    threads: u32,
    /// Frames that are timed; the medians count.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Also write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Medians of the parts of a frame, in milliseconds.
#[derive(Serialize)]
struct FrameCost {
    cloths: u16,
    n: u32,
    step: f64,
    record: f64,
    write: f64,
    /// The rest of the main world, less that of a paused frame.
    main: f64,
    /// Less those of a paused frame.
    extract: Option<f64>,
    render: Option<f64>,
    /// The whole of a paused frame.
    paused: f64,
}

/// Times of each frame.
#[derive(Default)]
struct Times {
    step: Vec<Duration>,
    record: Vec<Duration>,
    write: Vec<Duration>,
    main: Vec<Duration>,
    extract: Vec<Duration>,
    render: Vec<Duration>,
}

/// Measures all scenes, prints a table, and writes the figures to a file.
///
/// # Errors
/// If there is not one size for each number of cloths, or the file cannot be written.
pub fn report(arguments: &FrameArguments) -> Result<(), Box<dyn Error>> {
    let FrameArguments { cloths, sizes, .. } = arguments;
    if cloths.len() != sizes.len() {
        return Err(format!("{} numbers of cloths, but {} sizes", cloths.len(), sizes.len()).into());
    }
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header([
        "cloths",
        "step, ms",
        "record",
        "write",
        "main world",
        "extract",
        "prepare",
        "all but the step, in steps",
        "paused frame",
    ]);
    let scenes = cloths.iter().zip(sizes);
    let all: Vec<FrameCost> = scenes.map(|(&cloths, &n)| measure(arguments, cloths, n)).collect();
    for cost in &all {
        let FrameCost { cloths, n, step, record, write, main, extract, render, paused } = *cost;
        let or_none = |time: Option<f64>| time.map_or("-".into(), |time| format!("{time:.3}"));
        let besides = record + write + main + extract.unwrap_or(0.0) + render.unwrap_or(0.0);
        table.add_row([
            format!("{cloths} of {n} x {n}"),
            format!("{step:.3}"),
            format!("{record:.3}"),
            format!("{write:.3}"),
            format!("{main:.3}"),
            or_none(extract),
            or_none(render),
            format!("{:.2}", besides / step),
            format!("{paused:.3}"),
        ]);
    }
    println!("{table}");
    if let Some(path) = &arguments.json {
        write_json(path, &all)?;
    }
    Ok(())
}

/// The parts of a frame with `cloths` of `n` x `n` particles in the wind.
fn measure(arguments: &FrameArguments, cloths: u16, n: u32) -> FrameCost {
    let mut app = app(arguments);
    spawn(&mut app, cloths, n);
    run(&mut app, WARM_UP);
    let mut moving = run(&mut app, arguments.frames as usize);
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    run(&mut app, WARM_UP);
    let mut paused = run(&mut app, arguments.frames as usize);
    let of = |times: &mut Vec<Duration>| in_ms(median(times));
    let more = |moving: &mut Vec<Duration>, paused: &mut Vec<Duration>| {
        (!moving.is_empty()).then(|| of(moving) - of(paused))
    };
    let [step, record, write] = [&mut moving.step, &mut moving.record, &mut moving.write].map(of);
    let anyway = [&mut paused.main, &mut paused.extract, &mut paused.render];
    let anyway = anyway.map(|times| if times.is_empty() { 0.0 } else { of(times) });
    FrameCost {
        cloths,
        n,
        step,
        record,
        write,
        main: of(&mut moving.main) - anyway[0] - step - record - write,
        extract: more(&mut moving.extract, &mut paused.extract),
        render: more(&mut moving.render, &mut paused.render),
        paused: anyway.iter().sum(),
    }
}

/// An app with Bevy's renderer, without a window.
fn app(FrameArguments { threads, still, .. }: &FrameArguments) -> App {
    let threads = *threads as usize;
    let mut app = App::new();
    let policy = TaskPoolThreadAssignmentPolicy {
        min_threads: threads,
        max_threads: threads,
        percent: 1.0,
        on_thread_spawn: None,
        on_thread_destroy: None,
    };
    let pools = TaskPoolOptions {
        min_total_threads: 3 * threads,
        max_total_threads: 3 * threads,
        io: policy.clone(),
        async_compute: policy.clone(),
        compute: policy,
    };
    app.add_plugins(
        DefaultPlugins
            .build()
            .set(TaskPoolPlugin { task_pool_options: pools })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..RenderPlugin::default() })
            .disable::<bevy::log::LogPlugin>()
            .disable::<PipelinedRenderingPlugin>(),
    )
    .add_plugins(DrapePlugins::default())
    .insert_resource(Time::<Fixed>::from_duration(Duration::from_secs_f32(STEP)))
    .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    if !still {
        app.insert_resource(Wind {
            gusts: Gusts { speed: 2.0, ..Gusts::default() },
            lift_coefficient: 1.0,
            ..Wind::new(Vec3::new(4.0, 0.0, 1.0))
        });
    }
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    app.world_mut().resource_mut::<SceneManager>().sleeping = false;
    app
}

/// Curtains side by side, in rows.
fn spawn(app: &mut App, cloths: u16, n: u32) {
    let world = app.world_mut();
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(Color::WHITE);
    for i in 0..cloths {
        let place = Vec3::new(f32::from(i % 32), 0.0, f32::from(i / 32)) * SPACING;
        world.spawn((
            Cloth::new(2.0, 2.0).with_particles(n, n).with_pins(ClothPins::TopCorners),
            MeshMaterial3d(material.clone()),
            Transform::from_translation(place),
        ));
    }
}

/// Takes `frames` updates of `app`, whose parts are timed.
fn run(app: &mut App, frames: usize) -> Times {
    let mut times = Times::default();
    for _ in 0..frames {
        let apps = app.sub_apps_mut();
        let start = Instant::now();
        apps.main.run_default_schedule();
        times.main.push(start.elapsed());
        let has_device = apps.main.world().contains_resource::<RenderDevice>();
        for (label, sub_app) in &mut apps.sub_apps {
            let start = Instant::now();
            sub_app.extract(apps.main.world_mut());
            let extracted = start.elapsed();
            sub_app.update();
            if has_device && *label == bevy::app::AppLabel::intern(&RenderApp) {
                times.extract.push(extracted);
                times.render.push(start.elapsed() - extracted);
            }
        }
        let world = apps.main.world_mut();
        world.clear_trackers();
        times.step.push(world.resource::<StepTimes>().step);
        let MeshTimes { record, write } = *world.resource();
        times.record.push(record);
        times.write.push(write);
    }
    times
}
