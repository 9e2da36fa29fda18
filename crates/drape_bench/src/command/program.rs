//! The program: runs the subcommand of a command line.

use std::error::Error;
use std::process::ExitCode;

use clap::Parser;
use drape_solver::Isa;

use crate::command::arguments::{Arguments, Command, Task};
#[cfg(feature = "frame")]
use crate::experiments::frame;
#[cfg(feature = "gpu")]
use crate::experiments::gpu;
#[cfg(feature = "plugin")]
use crate::experiments::{broad, rollback, street};
use crate::experiments::{contact, contact_cost, fabrics, golden, presets, quality, shots, stability, torn};
use crate::failure::Failure;
use crate::measure::job::Job;
use crate::report::outcome::{Outcome, fill_ratios};
use crate::report::{plot, progress, remarks, table};
use crate::solvers::solver::Solver;

/// Runs the program, with these solvers to choose from.
pub fn main_with(solvers: &[Solver]) -> ExitCode {
    match run(&Arguments::parse().task, solvers) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs a subcommand.
fn run(task: &Task, solvers: &[Solver]) -> Result<(), Box<dyn Error>> {
    match task {
        Task::Measure(command) => measure(command, solvers)?,
        Task::Stability { sizes, steps } => stability::report(sizes, *steps as usize)?,
        Task::Shots(range) => shots::report(range)?,
        #[cfg(feature = "plugin")]
        Task::Broad(field) => broad::report(field)?,
        #[cfg(feature = "plugin")]
        Task::Street(street) => street::report(street)?,
        #[cfg(feature = "frame")]
        Task::Frame(arguments) => frame::report(arguments)?,
        #[cfg(feature = "plugin")]
        Task::Rollback(arguments) => rollback::report(arguments)?,
        Task::Contacts(trials) => contact_cost::report(trials)?,
        Task::Contact(runs) => contact::report::report(runs)?,
        Task::Torn(cuts) => torn::report(cuts)?,
        Task::Quality(arguments) => quality::report(arguments, solvers)?,
        Task::Presets => presets::report()?,
        Task::Fabrics(arguments) => fabrics::report(arguments)?,
        #[cfg(feature = "gpu")]
        Task::Gpu(arguments) => gpu::report(arguments)?,
        Task::Hashes { golden, threads } => {
            let hashes = golden::hashes(Isa::detected(), *threads)?;
            print!("{hashes}");
            if let Some(file) = golden {
                golden::compare(&hashes, file)?;
            }
        }
    }
    Ok(())
}

fn measure(command: &Command, solvers: &[Solver]) -> Result<(), Box<dyn Error>> {
    let common = command.common();
    let mut outcomes = measure_in_turns(&command.jobs(solvers)?, common.repeat)?;
    if matches!(command, Command::Compare { .. }) {
        fill_ratios(&mut outcomes);
    }
    println!("{}", common.summary());
    table::print(&outcomes);
    for remark in remarks::remarks(&outcomes) {
        println!("{remark}");
    }
    if let Some(path) = &common.csv {
        table::write_csv(path, &outcomes)?;
    }
    if let Some(path) = &common.json {
        table::write_json(path, &outcomes)?;
    }
    if let Some(path) = &common.plot {
        plot::draw(path, &outcomes)?;
    }
    Ok(())
}

/// Watches each job once, then times all jobs in turns: A B C A B C.
fn measure_in_turns(jobs: &[Job], repeat: u32) -> Result<Vec<Outcome>, Failure> {
    let progress = progress::bar(u64::from(repeat + 1) * jobs.len() as u64, "runs");
    let announce = |job: &Job| {
        let (scene, solver) = (job.scene.kind.name(), job.solver.name);
        progress.set_message(format!("{scene} {} {solver}", job.scene.n));
    };
    let mut motions = Vec::new();
    for job in jobs {
        announce(job);
        motions.push(job.watch()?);
        progress.inc(1);
    }
    let mut runs: Vec<Vec<_>> = jobs.iter().map(|_| Vec::new()).collect();
    for _ in 0..repeat {
        for (job, runs) in jobs.iter().zip(&mut runs) {
            announce(job);
            runs.push(job.time()?);
            progress.inc(1);
        }
    }
    progress.finish_and_clear();
    let outcome = |((job, motion), runs)| Outcome::new(job, motion, runs);
    Ok(jobs.iter().zip(&motions).zip(runs).map(outcome).collect())
}
