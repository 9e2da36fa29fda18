//! Scenes as tests: one named test for each scene file of a folder, run in parallel and chosen by name.
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
//! `cargo test --test scenes curtain` runs the scenes with `curtain` in their names; after `--`, `--list` lists all, and
//! `--nocapture` has them print what they measured beside what was expected.

use std::path::Path;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};

use crate::runner::{SCENE_SUFFIX, run_scene};
use crate::suite::scene_files;

/// Runs the scenes of `folder` as tests, as the command line of this process asks. The path is from the folder of the
/// package's `Cargo.toml`, where Cargo starts tests.
///
/// A test is called by the path of its file in the folder. It fails if the file is wrong, an expectation does not hold, or
/// the plugin refuses something.
pub fn test_scenes(folder: impl AsRef<Path>) -> ExitCode {
    let folder = folder.as_ref();
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
        Trial::test(name, move || {
            let report = run_scene(&file);
            if is_told {
                print!("{report}");
            }
            if report.passed() { Ok(()) } else { Err(Failed::from(report.complaint())) }
        })
    });
    libtest_mimic::run(&arguments, trials.collect()).exit_code()
}
