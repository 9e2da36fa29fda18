//! Measures the solver on the GPU beside the solver on the processor, on the same scenes.

use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_gpu::Gpu;
use serde::Serialize;

use crate::failure::Failure;
use crate::measure::median::{in_ms, median};
use crate::report::table::write_json;
use crate::scenes::model::Pins;
use crate::scenes::scene::{Scene, SceneKind};
use crate::solvers::drape::Drape;
use crate::solvers::gpu::{DrapeGpu, adapter};
use crate::solvers::options::SolverOptions;
use crate::solvers::simulation::Simulation;
use crate::solvers::threads::on_threads;

/// Time before timing begins: a GPU that was idle is slow at first.
const WARM_UP: Duration = Duration::from_millis(300);
/// Steps of the solver on the processor before timing begins.
const SKIPPED: usize = 5;
/// Steps that are submitted before one waits for them: what a game does whose frames the GPU limits.
const IN_FLIGHT: usize = 8;

/// Arguments of `gpu`.
#[derive(Args, Clone, Debug)]
pub struct GpuArguments {
    /// The scene; all of them if none is given.
    #[arg(long, value_enum)]
    scene: Option<SceneKind>,
    /// Sizes of the scene.
    #[arg(long, value_delimiter = ',', requires = "scene")]
    sizes: Vec<u32>,
    /// Substeps in a step of 1/60 s.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=256))]
    substeps: u32,
    /// Relaxation sweeps in a substep.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1024))]
    sweeps: u32,
    /// Steps that are timed; the medians count.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(8..=100_000))]
    steps: u32,
    /// Numbers of threads of the solver on the processor; 0 leaves it out.
    #[arg(long, value_delimiter = ',', default_values_t = [1])]
    threads: Vec<u32>,
    /// Also write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The figures of a scene.
#[derive(Serialize)]
struct GpuCost {
    scene: &'static str,
    n: u32,
    particles: usize,
    substeps: u32,
    sweeps: u32,
    adapter: String,
    /// Milliseconds of a step on the GPU's own clock: median and least.
    gpu_ms: Option<[f64; 2]>,
    /// Milliseconds from step to step, with some steps in flight.
    wall_ms: f64,
    /// Milliseconds that the thread needs to start a step.
    start_ms: f64,
    /// Threads and milliseconds of a step on the processor.
    cpu_ms: Vec<(u32, f64)>,
}

/// Measures the chosen scenes, and prints a table.
///
/// # Errors
/// If there is no adapter, or a scene does not fit the device.
pub fn report(arguments: &GpuArguments) -> Result<(), Box<dyn Error>> {
    let gpu = adapter()?;
    println!("{}, {} substeps x {} sweeps", gpu.adapter_name(), arguments.substeps, arguments.sweeps);
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header([
        "scene",
        "n",
        "particles",
        "GPU, ms",
        "least",
        "step to step, ms",
        "start, ms",
        "processor, ms",
    ]);
    let mut all = Vec::new();
    for (kind, n) in scenes(arguments) {
        let cost = measure(arguments, &gpu, &Scene::new(kind, n, Pins::Corners)?)?;
        let ms = |time: Option<f64>| time.map_or_else(|| "no clock".into(), |time| format!("{time:.3}"));
        table.add_row([
            cost.scene.to_string(),
            n.to_string(),
            cost.particles.to_string(),
            ms(cost.gpu_ms.map(|[median, _]| median)),
            ms(cost.gpu_ms.map(|[_, least]| least)),
            ms(Some(cost.wall_ms)),
            ms(Some(cost.start_ms)),
            cost.cpu_ms
                .iter()
                .map(|(threads, ms)| format!("{threads}: {ms:.2}"))
                .collect::<Vec<_>>()
                .join(", "),
        ]);
        all.push(cost);
    }
    println!("{table}");
    if let Some(path) = &arguments.json {
        write_json(path, &all)?;
    }
    Ok(())
}

fn scenes(arguments: &GpuArguments) -> Vec<(SceneKind, u32)> {
    let usual: &[(SceneKind, &[u32])] = &[
        (SceneKind::Sheet, &[16, 32, 64, 128, 256, 512, 1024, 2048]),
        (SceneKind::Many, &[10, 100, 1000, 10_000]),
        (SceneKind::Ropes, &[1000]),
        (SceneKind::Mesh, &[50_000]),
    ];
    match arguments.scene {
        Some(kind) if !arguments.sizes.is_empty() => arguments.sizes.iter().map(|&n| (kind, n)).collect(),
        chosen => {
            let chosen = usual.iter().filter(|(kind, _)| chosen.is_none_or(|chosen| chosen == *kind));
            chosen.flat_map(|&(kind, sizes)| sizes.iter().map(move |&n| (kind, n))).collect()
        }
    }
}

fn measure(arguments: &GpuArguments, gpu: &Gpu, scene: &Scene) -> Result<GpuCost, Failure> {
    let options =
        SolverOptions { substeps: arguments.substeps, sweeps: arguments.sweeps, ..SolverOptions::default() };
    let mut simulation = DrapeGpu::new(scene, &options)?;
    let start = Instant::now();
    while start.elapsed() < WARM_UP {
        for _ in 0..IN_FLIGHT {
            simulation.start_step()?;
        }
        gpu.wait()?;
    }
    let mut on_gpu = Vec::new();
    for _ in 0..arguments.steps {
        simulation.start_step()?;
        on_gpu.extend(simulation.world().read_step_time()?);
    }
    let (mut rounds, mut starts) = (Vec::new(), Vec::new());
    for _ in 0..arguments.steps as usize / IN_FLIGHT {
        let round = Instant::now();
        for _ in 0..IN_FLIGHT {
            let start = Instant::now();
            simulation.start_step()?;
            starts.push(start.elapsed());
        }
        gpu.wait()?;
        rounds.push(round.elapsed() / IN_FLIGHT as u32);
    }
    on_gpu.sort_unstable();
    Ok(GpuCost {
        scene: scene.kind.name(),
        n: scene.n,
        particles: scene.particle_count(),
        substeps: arguments.substeps,
        sweeps: arguments.sweeps,
        adapter: gpu.adapter_name().to_string(),
        gpu_ms: on_gpu.first().map(|&least| [on_gpu[on_gpu.len() / 2], least].map(in_ms)),
        wall_ms: in_ms(median(&mut rounds)),
        start_ms: in_ms(median(&mut starts)),
        cpu_ms: on_processor(arguments, scene, &options)?,
    })
}

/// Milliseconds of a step of the solver on the processor, for each number of threads.
fn on_processor(
    arguments: &GpuArguments,
    scene: &Scene,
    options: &SolverOptions,
) -> Result<Vec<(u32, f64)>, Failure> {
    let counts = arguments.threads.iter().copied().filter(|&threads| threads > 0);
    let time = |threads| {
        let options = SolverOptions { threads, ..*options };
        let steps = arguments.steps as usize / 2;
        let mut times = on_threads(threads, || -> Result<Vec<Duration>, Failure> {
            let mut simulation = Drape::new(scene, &options)?;
            (0..steps + SKIPPED).map(|_| simulation.step()).collect()
        })??;
        Ok((threads, in_ms(median(&mut times[SKIPPED..]))))
    };
    counts.map(time).collect()
}
