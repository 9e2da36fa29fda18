//! A cannon bombards a curtain: the founding experiment.
//!
//! `cargo run --release --example cannon -- --headless --shots 5 --out DIR` runs it without a window and writes a
//! report, a plot and, with `--features render` and `--frames`, pictures.
//! `--table1` measures collision detection by five methods instead, `--soak SECONDS` fires without end.
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

use std::error::Error;
use std::process::ExitCode;

use clap::Parser;
use drape_examples::cannon_demo::arguments::Arguments;
use drape_examples::cannon_demo::headless;
use drape_examples::cannon_demo::soak;
use drape_examples::cannon_demo::table1;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    #[cfg(feature = "window")]
    if !arguments.headless && !arguments.frames && !arguments.table1 && arguments.soak.is_none() {
        return match drape_examples::cannon_demo::window::run(&arguments) {
            Ok(bevy::app::AppExit::Success) => ExitCode::SUCCESS,
            Ok(bevy::app::AppExit::Error(code)) => ExitCode::from(code.get()),
            Err(error) => fail(&error),
        };
    }
    let outcome: Result<(), Box<dyn Error>> = if arguments.table1 {
        table1::run(&arguments).map_err(Into::into)
    } else if let Some(seconds) = arguments.soak {
        soak::run(&arguments, seconds).map_err(Into::into)
    } else {
        headless::run(&arguments).map_err(Into::into)
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => fail(&*error),
    }
}

fn fail(error: &dyn Error) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::FAILURE
}
