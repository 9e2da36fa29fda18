//! Scenes as tests: one named test per scene file of a folder, run in parallel and filtered by name.
//!
//! In `Cargo.toml`:
//!
//! ```toml
//! [[test]]
//! name = "scenes"
//! harness = false
//! ```
//!
//! and in `tests/scenes.rs`:
//!
//! ```no_run
//! fn main() -> std::process::ExitCode {
//!     bevy_drape_script::harness::test_scenes("assets/scenes")
//! }
//! ```
//!
//! `cargo test --test scenes curtain` runs the scenes with `curtain` in their names; after `--`, `--list` lists all,
//! and `--nocapture` prints measured beside expected values.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};

use super::runner::run_scene;
use super::scene_files::{SCENE_SUFFIX, scene_files};

/// Runs the scenes of `folder` as tests, filtered by the command line of this process. The path is relative to the
/// folder of the package's `Cargo.toml`, where Cargo starts tests.
///
/// Tests are named after the paths of their files in the folder. A test fails if the file has errors, an expectation
/// does not hold, or the plugin refuses something.
pub fn test_scenes(folder: impl AsRef<Path>) -> ExitCode {
    run(folder.as_ref(), None)
}

/// Runs the scenes of `folder` as tests, each of which has to end in the state in `table`: a text file with a scene's
/// name and its state hash on each line. So every change of behaviour is noticed, on any machine.
pub fn test_scenes_to_the_bit(folder: impl AsRef<Path>, table: impl AsRef<Path>) -> ExitCode {
    let table = table.as_ref();
    match std::fs::read_to_string(table) {
        Ok(text) => run(folder.as_ref(), Some(&hashes_in(&text))),
        Err(error) => {
            eprintln!("{}: {error}", table.display());
            ExitCode::FAILURE
        }
    }
}

/// State hashes by scene name.
type Hashes = BTreeMap<String, String>;

fn hashes_in(text: &str) -> Hashes {
    let lines = text.lines().filter_map(|line| line.split_once(' '));
    lines.map(|(name, hash)| (name.to_string(), hash.trim().to_string())).collect()
}

fn run(folder: &Path, hashes: Option<&Hashes>) -> ExitCode {
    let arguments = Arguments::from_args();
    let files = match scene_files(folder) {
        Ok(files) => files,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let is_told = arguments.nocapture;
    let trials = files.into_iter().map(|file| {
        let name = file.strip_prefix(folder).unwrap_or(&file).to_string_lossy().replace('\\', "/");
        let name = name.strip_suffix(SCENE_SUFFIX).unwrap_or(&name).to_string();
        let expected = hashes.map(|hashes| hashes.get(&name).cloned().unwrap_or_default());
        Trial::test(name, move || {
            let report = run_scene(&file);
            if is_told {
                print!("{report}");
            }
            if !report.passed() {
                return Err(Failed::from(report.complaint()));
            }
            match expected.filter(|expected| *expected != report.state_hash) {
                Some(expected) => Err(Failed::from(format!(
                    "{}: the state hash is {}, not {expected} as in the table",
                    report.scene, report.state_hash
                ))),
                None => Ok(()),
            }
        })
    });
    libtest_mimic::run(&arguments, trials.collect()).exit_code()
}
