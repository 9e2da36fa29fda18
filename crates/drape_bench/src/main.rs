//! Named scenes, this solver and its peers: what a step costs and how far the cloth stretches.
//!
//! `cargo run --release -p drape_bench -- run --n 128 --solver drape` measures one solver;
//! `compare --sizes 32,64,128 --solvers drape,naive,coloured` measures several in turns, so that a noisy machine is
//! noisy for all of them.

mod coloured;
mod contender;
mod drape;
mod naive;
mod run;
mod table;
mod workload;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

use crate::contender::Solver;
use crate::run::{Job, Outcome, measure};
use crate::table::{fill_ratios, print, write_csv, write_json};
use crate::workload::{Pins, Sheet};

#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measures one solver.
    Run {
        /// Particles in a row and in a column of the sheet.
        #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(3..=4096))]
        n: u32,
        /// The solver.
        #[arg(long, value_enum, default_value_t = Solver::Drape)]
        solver: Solver,
        #[command(flatten)]
        common: Common,
    },
    /// Measures several solvers and sizes in turns.
    Compare {
        /// Sizes of the sheet.
        #[arg(long, value_delimiter = ',', default_values_t = [32, 64, 128, 256], value_parser = clap::value_parser!(u32).range(3..=4096))]
        sizes: Vec<u32>,
        /// The solvers.
        #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Solver::Drape, Solver::Naive, Solver::Coloured])]
        solvers: Vec<Solver>,
        #[command(flatten)]
        common: Common,
    },
}

#[derive(Args)]
struct Common {
    /// Substeps in a step of 1/60 s.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=256))]
    substeps: u32,
    /// Relaxation sweeps in a substep.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    sweeps: u32,
    /// Which particles are pinned.
    #[arg(long, value_enum, default_value_t = Pins::Corners)]
    pins: Pins,
    /// How often each is measured; the median and the least count.
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,
    /// Steps of a run; the first tenth is not timed.
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(10..=100_000))]
    steps: u32,
    /// Also write the table as comma-separated values.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Also write the table as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    let (jobs, common, is_comparison) = match Arguments::parse().command {
        Command::Run { n, solver, common } => (vec![job(n, solver, &common)], common, false),
        Command::Compare { sizes, solvers, common } => {
            let pairs = sizes.iter().flat_map(|&n| solvers.iter().map(move |&solver| (n, solver)));
            (pairs.map(|(n, solver)| job(n, solver, &common)).collect(), common, true)
        }
    };
    let mut outcomes = measure_in_turns(&jobs, common.repeat);
    if is_comparison {
        fill_ratios(&mut outcomes);
    }
    print(&outcomes);
    let csv = common.csv.map_or(Ok(()), |path| write_csv(&path, &outcomes));
    let json = common.json.map_or(Ok(()), |path| write_json(&path, &outcomes));
    match csv.and(json) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn job(n: u32, solver: Solver, common: &Common) -> Job {
    Job {
        sheet: Sheet { n, pins: common.pins },
        solver,
        substeps: common.substeps,
        sweeps: common.sweeps,
        steps: common.steps as usize,
    }
}

/// Runs all jobs once, then all again: A B C A B C.
fn measure_in_turns(jobs: &[Job], repeat: u32) -> Vec<Outcome> {
    let progress = ProgressBar::new(u64::from(repeat) * jobs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} runs, {elapsed} {msg}") {
        progress.set_style(style);
    }
    let mut runs: Vec<Vec<_>> = jobs.iter().map(|_| Vec::new()).collect();
    for _ in 0..repeat {
        for (job, runs) in jobs.iter().zip(&mut runs) {
            progress.set_message(format!("{} n = {}", job.solver.name(), job.sheet.n));
            runs.push(measure(job));
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    jobs.iter().zip(runs).map(|(job, runs)| Outcome::new(job, runs)).collect()
}
