//! Runs scripted scenes: with a verdict and without a window, or in one.
//!
//! `cargo run --release --features scenes --example scene -- assets/scenes --headless` runs all scenes of a folder as a suite;
//! the exit code is the verdict. `--set PATH=VALUE` changes a scene, `--report junit` writes for CI systems, `--record FILE` keeps where
//! everything was, to the last bit, and `--replay FILE` shows it; `--diff OTHER` tells where two recordings part.
//!
//! `cargo run --release --example scene --features window -- FILE` opens a window, in which the scene begins anew whenever
//! its file is saved:
//!
//! | keys | |
//! |---|---|
//! | P or space | pause |
//! | O | one step |
//! | T | slow motion |
//! | R | from the beginning |
//! | C | the next camera of the scene |
//! | G | strain of the sticks |
//! | right mouse button, wheel | turn and zoom |
//! | H | help on the screen |
//! | Esc | quit |
//!
//! With `--replay` the window shows a recording:
//!
//! | keys | |
//! |---|---|
//! | drag the bar at the bottom | to any step |
//! | P or space | play and pause |
//! | left and right, with shift by ten | a step back and forth |
//! | home, end | first and last step |

use std::process::ExitCode;

use clap::Parser;
use drape_examples::scripted::arguments::SceneArguments;
use drape_examples::scripted::{replay as scene_replay, suite as scene_suite};

fn main() -> ExitCode {
    let arguments = SceneArguments::parse();
    let verdict = if let Some(recording) = arguments.recording() {
        replay(&arguments, recording)
    } else if arguments.diff.is_some() {
        Err("`--diff OTHER` compares recordings: give it one too, as in `scene A.drape --diff B.drape`"
            .into())
    } else {
        play(&arguments)
    };
    match verdict {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            // As for a command line that cannot be understood: there is no verdict.
            ExitCode::from(2)
        }
    }
}

fn replay(
    arguments: &SceneArguments,
    recording: &std::path::Path,
) -> Result<bool, Box<dyn std::error::Error>> {
    #[cfg(feature = "window")]
    if !arguments.headless && arguments.diff.is_none() {
        return drape_examples::scripted::replay_window::run(recording).map_err(Into::into);
    }
    scene_replay::run(recording, arguments.diff.as_deref()).map_err(Into::into)
}

fn play(arguments: &SceneArguments) -> Result<bool, Box<dyn std::error::Error>> {
    #[cfg(feature = "window")]
    if !arguments.headless {
        return drape_examples::scripted::window::run(arguments).map_err(Into::into);
    }
    scene_suite::run(arguments).map_err(Into::into)
}
