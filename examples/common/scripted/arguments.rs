//! The command line of the scene runner.

use std::path::{Path, PathBuf};

use bevy_drape_script::Override;
use clap::{Parser, ValueEnum};

/// Runs scripted scenes and checks their expectations.
#[derive(Clone, Debug, Parser)]
#[command(version, about)]
pub struct SceneArguments {
    /// Scene files (*.scene.ron), folders of them, checkpoints (*.checkpoint) to go on from, or one recording (*.drape) to show.
    #[arg(value_name = "FILE", required_unless_present = "replay", conflicts_with = "replay")]
    pub files: Vec<PathBuf>,

    /// Run without a window, as fast as the machine can. Without the feature `window` scenes always do.
    #[arg(long)]
    pub headless: bool,

    /// Change a value of every scene by its path, or a parameter by its name; may be given several times.
    #[arg(long = "set", value_name = "PATH=VALUE", conflicts_with = "replay")]
    pub overrides: Vec<Override>,

    /// Record where everything is after each step: to this file, or of several scenes to this folder.
    #[arg(long, value_name = "FILE", conflicts_with = "replay")]
    pub record: Option<PathBuf>,

    /// Show a recording.
    #[arg(long, value_name = "FILE")]
    pub replay: Option<PathBuf>,

    /// Compare with another recording, and fail if the two differ.
    #[arg(long, value_name = "OTHER")]
    pub diff: Option<PathBuf>,

    /// Draw the pictures that scenes take into this folder (needs the feature `render`).
    #[arg(long, value_name = "DIR", conflicts_with = "replay")]
    pub frames: Option<PathBuf>,

    /// Draw speed and stretch of all bodies over time, to `NAME.svg` in the folder of `--out`.
    #[arg(long, conflicts_with = "replay")]
    pub plot: bool,

    /// Folder for plots and checkpoints; made if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/scenes")]
    pub out: PathBuf,

    /// Write the verdicts to the standard output in this format, and all else to the standard error.
    #[arg(long, value_name = "FORMAT", conflicts_with = "replay")]
    pub report: Option<ReportFormat>,
}

impl SceneArguments {
    /// The recording to be shown: that of `--replay`, or the only file, if it is one.
    pub fn recording(&self) -> Option<&Path> {
        let is_recording = |file: &&PathBuf| file.extension().is_some_and(|extension| extension == "drape");
        let only = self.files.first().filter(|file| self.files.len() == 1 && is_recording(file));
        self.replay.as_ref().or(only).map(PathBuf::as_path)
    }
}

/// A format that programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReportFormat {
    /// JUnit XML, for CI systems: a test suite for each scene, a test case for each expectation.
    Junit,
    /// JSON: a list of reports.
    Json,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_arguments_are_taken_and_bad_ones_named() {
        let parse = |line: &str| SceneArguments::try_parse_from(line.split_whitespace());
        let line = "scene a.scene.ron scenes --headless --set curtain.particles=[9,8] --report junit";
        let arguments = parse(line).expect("valid");
        assert_eq!((arguments.files.len(), arguments.overrides.len()), (2, 1));
        assert_eq!(arguments.report, Some(ReportFormat::Junit));
        for line in ["scene --replay a.drape --diff b.drape", "scene a.drape --diff b.drape"] {
            assert_eq!(parse(line).expect(line).recording(), Some(Path::new("a.drape")));
        }
        assert_eq!(parse("scene a.scene.ron --diff b.drape").expect("valid").recording(), None);
        for (line, needle) in [
            ("scene", "FILE"),
            ("scene a --colour red", "--colour"),
            ("scene a --set nonsense", "PATH=VALUE"),
            ("scene a --report html", "junit"),
            ("scene a --replay b", "cannot be used with"),
        ] {
            let message = parse(line).expect_err(line).to_string();
            assert!(message.contains(needle), "{message}");
        }
    }
}
