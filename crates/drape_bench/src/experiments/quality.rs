//! Time to quality: the cost of a step at which a sheet stretches by no more than so much.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};

use crate::failure::Failure;
use crate::measure::job::Job;
use crate::measure::median::{in_ms, median};
use crate::report::progress;
use crate::report::quality::{Trial, draw};
use crate::report::table::{name_of, write_json};
use crate::scenes::model::Pins;
use crate::scenes::scene::{Scene, SceneKind};
use crate::solvers::options::SolverOptions;
use crate::solvers::solver::Solver;

/// Greatest stretch in motion, root mean square.
const TARGETS: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// Substeps that are tried, until the last target is met.
const SUBSTEPS: [u32; 16] = [2, 3, 4, 6, 8, 10, 12, 14, 16, 20, 24, 32, 48, 64, 96, 128];

/// The sheets, the solvers, and where to write the figures.
#[derive(Args, Clone, Debug)]
pub struct QualityArguments {
    /// Sizes of the sheet.
    #[arg(long, value_delimiter = ',', default_values_t = [32, 64, 128, 256])]
    sizes: Vec<u32>,
    /// The pinned particles.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Pins::Corners, Pins::Edge])]
    pins: Vec<Pins>,
    /// The solvers.
    #[arg(long, value_delimiter = ',', default_values_t = ["drape", "coloured"].map(String::from))]
    solvers: Vec<String>,
    /// Number of timed runs of each; the median is reported.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,
    /// Steps of a run; the first tenth is neither timed nor counted as motion.
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(10..=100_000))]
    steps: u32,
    /// Milliseconds per step from which on no more substeps are tried.
    #[arg(long, default_value_t = 100.0)]
    most_ms: f64,
    /// Also write all figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Also draw them, as SVG.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
}

/// Measures all choices, prints the cheapest for each target, and writes and draws all of them.
///
/// # Errors
/// If a solver is not known or fails, or a file cannot be written.
pub fn report(arguments: &QualityArguments, known: &[Solver]) -> Result<(), Box<dyn std::error::Error>> {
    let QualityArguments { sizes, pins, solvers, json, plot, .. } = arguments;
    let solvers: Vec<_> = solvers.iter().map(|name| Solver::find(name, known)).collect::<Result<_, _>>()?;
    let progress = progress::bar((sizes.len() * pins.len() * solvers.len()) as u64, "sheets");
    let mut trials = Vec::new();
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header(["n", "pins", "stretch", "solver", "ms a step", "substeps"]);
    for (&n, &pins) in sizes.iter().flat_map(|n| pins.iter().map(move |pins| (n, pins))) {
        let scene = Arc::new(Scene::new(SceneKind::Sheet, n, pins)?);
        let first = trials.len();
        for &solver in &solvers {
            for lines in [false, true].into_iter().filter(|lines| !lines || solver.name == "drape") {
                trials.extend(arguments.climb(&scene, solver, pins, lines)?);
            }
            progress.inc(1);
        }
        for target in TARGETS {
            for solver in &solvers {
                let best = cheapest(&trials[first..], solver.name, target);
                let (ms, how) = best.map_or_else(
                    || ("not reached".into(), String::new()),
                    |best| {
                        let lines = if best.lines { ", lines" } else { "" };
                        (format!("{:.3}", best.ms), format!("{}{lines}", best.substeps))
                    },
                );
                let stretch = format!("{} %", target * 100.0);
                table.add_row([n.to_string(), name_of(&pins), stretch, solver.name.into(), ms, how]);
            }
        }
    }
    progress.finish_and_clear();
    println!("{table}");
    if let Some(path) = json {
        write_json(path, &trials)?;
    }
    if let Some(path) = plot {
        draw(path, &trials)?;
    }
    Ok(())
}

impl QualityArguments {
    /// Tries more and more substeps, until the last target is met or a step takes too long.
    fn climb(
        &self,
        scene: &Arc<Scene>,
        solver: Solver,
        pins: Pins,
        lines: bool,
    ) -> Result<Vec<Trial>, Box<dyn std::error::Error>> {
        let mut trials = Vec::new();
        for substeps in SUBSTEPS {
            let options = SolverOptions { substeps, lines, ..SolverOptions::default() };
            let job = Job { scene: Arc::clone(scene), solver, options, steps: self.steps as usize };
            let rms = job.watch()?.motion.rms;
            let times = (0..self.repeat).map(|_| Ok(job.time()?.step));
            let ms = in_ms(median(&mut times.collect::<Result<Vec<_>, Failure>>()?));
            trials.push(Trial {
                solver: solver.name,
                n: scene.n,
                pins: name_of(&pins),
                rms,
                ms,
                substeps,
                lines,
            });
            if rms <= TARGETS[TARGETS.len() - 1] || ms > self.most_ms {
                break;
            }
        }
        Ok(trials)
    }
}

/// The cheapest choice of a solver that stretches by no more than `target`.
fn cheapest<'a>(trials: &'a [Trial], solver: &str, target: f64) -> Option<&'a Trial> {
    let good = trials.iter().filter(|trial| trial.solver == solver && trial.rms <= target);
    good.min_by(|a, b| a.ms.total_cmp(&b.ms))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solvers::solver::OWN;

    #[test]
    fn the_cheapest_choice_that_is_good_enough_is_found() {
        let trial =
            |solver, rms, ms| Trial { solver, n: 8, pins: "edge".into(), rms, ms, substeps: 8, lines: false };
        let trials =
            [trial("a", 0.02, 1.0), trial("a", 0.01, 3.0), trial("a", 0.005, 2.0), trial("b", 0.0, 0.1)];
        let ms = |target| cheapest(&trials, "a", target).map(|trial| trial.ms);
        assert_eq!([1e-2, 1e-3].map(ms), [Some(2.0), None]);
    }

    /// More substeps stretch less, and those of this solver with lines least.
    #[test]
    fn substeps_are_added_until_the_stretch_is_small() {
        let arguments = QualityArguments {
            sizes: vec![16],
            pins: vec![Pins::Edge],
            solvers: Vec::new(),
            repeat: 1,
            steps: 40,
            most_ms: f64::INFINITY,
            json: None,
            plot: None,
        };
        let scene = Arc::new(Scene::new(SceneKind::Sheet, 16, Pins::Edge).expect("a scene"));
        let drape = Solver::find("drape", OWN).expect("known");
        let climb = |lines| arguments.climb(&scene, drape, Pins::Edge, lines).expect("it runs");
        let [sweeps, lines] = [false, true].map(climb);
        let stretch_at_8 =
            |trials: &[Trial]| trials.iter().find(|trial| trial.substeps == 8).map(|trial| trial.rms);
        let [first, last] = [sweeps.first(), sweeps.last()].map(|trial| trial.expect("some").rms);
        assert!(first > 10.0 * last, "{sweeps:?}");
        assert!(stretch_at_8(&lines) < stretch_at_8(&sweeps), "{lines:?}");
        assert!(lines[..lines.len() - 1].iter().all(|trial| trial.rms > 1e-4), "{lines:?}");
        let hasty = QualityArguments { most_ms: 0.0, ..arguments.clone() };
        assert_eq!(hasty.climb(&scene, drape, Pins::Edge, true).expect("it runs").len(), 1);
    }
}
