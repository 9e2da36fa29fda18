//! Runs scenes and modes in order, and prints a table.

use std::error::Error;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};

use crate::experiments::contact::scene::ContactScene;
use crate::experiments::contact::trial::{Accuracy, Figures, Mode, Trial};
use crate::failure::Failure;
use crate::report::progress;
use crate::report::table::{name_of, write_json};

/// Arguments of `contact`.
#[derive(Args, Clone, Debug)]
pub struct ContactRuns {
    /// Scenes: fold20, fold40, stack, twistin, twist, bowline, box, sleeve, funnel, swing, curtain, several with commas, or all.
    #[arg(long, default_value = "fold20", value_parser = chosen::<ContactScene>)]
    scene: Chosen<ContactScene>,
    /// Modes of self-contact: off, on, several with commas, or all.
    #[arg(long, default_value = "on", value_parser = chosen::<Mode>)]
    mode: Chosen<Mode>,
    /// Accuracy of all bodies.
    #[arg(long, value_enum, default_value_t = Accuracy::Medium)]
    quality: Accuracy,
    /// Distance in metres that all bodies keep; by default 0.005.
    #[arg(long, value_name = "METRES")]
    thickness: Option<f32>,
    /// Steps of 1/60 s.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
    /// Threads.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    threads: u32,
    /// Searches every step for crossings, not only each tenth and the last.
    #[arg(long)]
    every_step: bool,
    /// Also write the results as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Values of one argument.
#[derive(Clone, Debug)]
struct Chosen<T>(Vec<T>);

/// Reads names with commas between them, or `all`.
fn chosen<T: ValueEnum>(names: &str) -> Result<Chosen<T>, String> {
    if names == "all" {
        return Ok(Chosen(T::value_variants().to_vec()));
    }
    let known = || T::value_variants().iter().map(name_of).collect::<Vec<_>>().join(", ");
    let read =
        |name| T::from_str(name, false).map_err(|_| format!("there is no {name}, but {} and all", known()));
    names.split(',').map(read).collect::<Result<_, _>>().map(Chosen)
}

impl ContactRuns {
    fn trials(&self) -> Vec<Trial> {
        let &Self { quality, thickness, threads, every_step, .. } = self;
        let steps = self.steps as usize;
        let trial = |scene, mode| Trial { scene, mode, quality, thickness, threads, steps, every_step };
        self.scene
            .0
            .iter()
            .flat_map(|&scene| self.mode.0.iter().map(move |&mode| trial(scene, mode)))
            .collect()
    }
}

/// Runs all scenes in all modes, and prints a table.
///
/// # Errors
/// If the solver refuses a scene or a step, or the file cannot be written.
pub fn report(runs: &ContactRuns) -> Result<(), Box<dyn Error>> {
    let trials = runs.trials();
    let progress = progress::bar(trials.len() as u64 * u64::from(runs.steps), "steps");
    let measure = |trial: &Trial| {
        progress.set_message(format!("{} {}", name_of(&trial.scene), name_of(&trial.mode)));
        trial.measure(|| progress.inc(1))
    };
    let figures: Vec<Figures> = trials.iter().map(measure).collect::<Result<_, Failure>>()?;
    progress.finish_and_clear();
    println!("{}", table(&figures));
    if let Some(path) = &runs.json {
        write_json(path, &figures)?;
    }
    Ok(())
}

fn table(figures: &[Figures]) -> Table {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED).set_header([
        "scene",
        "mode",
        "quality",
        "thickness, m",
        "threads",
        "steps",
        "particles",
        "step, ms",
        "p99",
        "most",
        "processor",
        "pairs",
        "lists",
        "truncated",
        "unfinished",
        "crossings",
        "at the end",
        "steps with any",
        "speed, m/s",
        "hash",
    ]);
    let count = |count: Option<usize>| count.map_or_else(|| "-".to_owned(), |count| count.to_string());
    let time = |ms: f64| format!("{ms:.2}");
    for run in figures {
        table.add_row([
            run.scene.clone(),
            run.mode.clone(),
            run.quality.clone(),
            format!("{:.4}", run.thickness),
            run.threads.to_string(),
            run.steps.to_string(),
            run.particles.to_string(),
            time(run.ms_mean),
            time(run.ms_p99),
            time(run.ms_max),
            run.cpu_ms_mean.map_or_else(|| "-".to_owned(), time),
            run.pairs.to_string(),
            run.rebuilds.to_string(),
            run.truncated.to_string(),
            run.unfinished.to_string(),
            count(run.crossings_max),
            count(run.crossings_end),
            format!("{} of {}", count(run.steps_with_crossings), run.steps_searched),
            format!("{:.4}", run.rms_speed_end),
            run.hash.clone(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_chosen_by_name_several_or_all() {
        let scenes = |names| chosen::<ContactScene>(names).map(|Chosen(scenes)| scenes);
        assert_eq!(scenes("twistin,box"), Ok(vec![ContactScene::Twistin, ContactScene::Box]));
        assert_eq!(scenes("all").map(|scenes| scenes.len()), Ok(11));
        let message = scenes("fold20,knot").expect_err("unknown");
        assert!(message.contains("no knot") && message.contains("bowline"), "{message}");
    }
}
