//! A cannon bombards a curtain: the founding experiment.
//!
//! `cargo run --release --example cannon -- --headless --shots 5 --out DIR` runs it without a window and writes a
//! report, a plot and, with `--features render` and `--frames`, pictures.
//! `--features table1` and `--table1` measure collision detection by five methods instead; `--soak SECONDS` fires without end.
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

use drape_examples::cannon_demo::arguments::Arguments;
use drape_examples::cannon_demo::{headless, soak};

fn main() -> ExitCode {
    #[cfg(not(all(feature = "web", target_family = "wasm")))]
    let arguments = <Arguments as clap::Parser>::parse();
    #[cfg(all(feature = "web", target_family = "wasm"))]
    let Some(arguments) = drape_examples::cannon_demo::page::arguments() else { return ExitCode::FAILURE };
    #[cfg(feature = "window")]
    if !arguments.headless
        && !arguments.frames
        && !arguments.film
        && !arguments.table1
        && arguments.soak.is_none()
    {
        return match drape_examples::cannon_demo::window::run(&arguments) {
            Ok(bevy::app::AppExit::Success) => ExitCode::SUCCESS,
            Ok(bevy::app::AppExit::Error(code)) => ExitCode::from(code.get()),
            Err(error) => fail(&error),
        };
    }
    let outcome: Result<(), Box<dyn Error>> = if arguments.film {
        draw_film(&arguments)
    } else if arguments.table1 {
        run_table1(&arguments)
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

#[cfg(feature = "render")]
fn draw_film(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(&arguments.out)?;
    let on_picture = |path: &std::path::Path| println!("{}", path.display());
    Ok(drape_examples::cannon_demo::film::draw(&arguments.scene(), &arguments.out, on_picture)?)
}

#[cfg(not(feature = "render"))]
fn draw_film(_: &Arguments) -> Result<(), Box<dyn Error>> {
    Err("`--film` needs the feature `render`".into())
}

#[cfg(feature = "table1")]
fn run_table1(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    Ok(drape_examples::cannon_demo::table1::run(arguments)?)
}

#[cfg(not(feature = "table1"))]
fn run_table1(_: &Arguments) -> Result<(), Box<dyn Error>> {
    Err("`--table1` needs the feature `table1`: cargo run --release --features table1 --example cannon -- --table1".into())
}

fn fail(error: &dyn Error) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::FAILURE
}
