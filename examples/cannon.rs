//! A cannon bombards a curtain: the founding experiment.
//!
//! `cargo run --release --example cannon -- --headless --shots 5 --out DIR` runs it without a window and writes a
//! report, a plot and, with `--features render` and `--frames`, pictures.
//!
//! `cargo run --release --example cannon --features window` opens a window:
//!
//! | keys | |
//! |---|---|
//! | arrow keys or WASD | aim |
//! | + and - | muzzle speed |
//! | space, or a click beside the cloth | fire |
//! | left mouse button on the cloth | drag it |
//! | right mouse button, wheel | turn and zoom |
//! | V | wind |
//! | P, O, T | pause, one step, slow motion |
//! | G | strain of the sticks, then wireframe |
//! | R | a new curtain, no balls |
//! | H | help on the screen |
//! | Esc | quit |

use std::process::ExitCode;

use clap::Parser;
use drape_examples::arguments::Arguments;
use drape_examples::headless;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    #[cfg(feature = "window")]
    if !arguments.headless && !arguments.frames {
        return match drape_examples::window::run(&arguments) {
            Ok(bevy::app::AppExit::Success) => ExitCode::SUCCESS,
            Ok(bevy::app::AppExit::Error(code)) => ExitCode::from(code.get()),
            Err(error) => fail(&error),
        };
    }
    match headless::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => fail(&error),
    }
}

fn fail(error: &dyn std::error::Error) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::FAILURE
}
