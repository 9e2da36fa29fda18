//! Named scenes, this solver and its peers: what a step costs and how far the cloth stretches.
//!
//! `cargo run --release -p drape_bench -- run --n 128 --solver drape` measures one solver;
//! `compare --scene sheet --sizes 32,64,128 --solvers drape,naive,coloured` measures several in turns, so that a
//! noisy machine is noisy for all of them.
//!
//! `stability` looks whether any choice of settings gains energy; `hashes` prints what must be the same on every machine;
//! `shots` counts the balls that pass through a curtain; `broad` measures many cloths among many obstacles, `contacts` what
//! each kind of contact costs per particle; `street` measures what levels of detail spare; `presets` measures the materials that have names.
//!
//! A library too, so that the peers that bring an old Bevy can be compiled apart, in `peers`: they hand their own
//! [`Solver`]s to [`main_with`].

pub mod arguments;
pub mod bombardment;
#[cfg(feature = "plugin")]
pub mod broad;
pub mod collision;
pub mod coloured;
pub mod contact_cost;
pub mod contender;
pub mod drape;
pub mod golden;
pub mod memory_pass;
pub mod mesh;
pub mod model;
pub mod naive;
pub mod oracle;
pub mod outcome;
pub mod plot;
#[cfg(feature = "plugin")]
pub mod plugin;
pub mod presets;
pub mod random;
pub mod remarks;
pub mod rope;
pub mod run;
pub mod scalar;
pub mod scene;
pub mod sheet;
pub mod shots;
pub mod solver;
pub mod stability;
#[cfg(feature = "plugin")]
pub mod street;
pub mod stretch;
pub mod table;
pub mod table1;
pub mod torn;
pub mod world;

use std::error::Error;
use std::process::ExitCode;

use clap::Parser;
use drape_solver::Isa;
use indicatif::{ProgressBar, ProgressStyle};

use crate::arguments::{Arguments, Command, Task};
use crate::contender::Failure;
use crate::outcome::{Outcome, fill_ratios};
use crate::run::Job;
use crate::solver::Solver;

/// The whole program, with these solvers to choose from.
pub fn main_with(solvers: &[Solver]) -> ExitCode {
    match work(&Arguments::parse().task, solvers) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn work(task: &Task, solvers: &[Solver]) -> Result<(), Box<dyn Error>> {
    match task {
        Task::Measure(command) => measure(command, solvers)?,
        Task::Stability { sizes, steps } => stability::report(sizes, *steps as usize)?,
        Task::Shots(range) => shots::report(range)?,
        #[cfg(feature = "plugin")]
        Task::Broad(field) => broad::report(field)?,
        #[cfg(feature = "plugin")]
        Task::Street(street) => street::report(street)?,
        Task::Contacts(trials) => contact_cost::report(trials)?,
        Task::Torn(cuts) => torn::report(cuts)?,
        Task::Presets => presets::report()?,
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

/// Watches each job once, then times all of them once, then all again: A B C A B C.
fn measure_in_turns(jobs: &[Job], repeat: u32) -> Result<Vec<Outcome>, Failure> {
    let progress = ProgressBar::new(u64::from(repeat + 1) * jobs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} runs, {elapsed} {msg}") {
        progress.set_style(style);
    }
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
