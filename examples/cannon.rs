//! A cannon bombards a curtain: the founding experiment.
//!
//! `cargo run --release --example cannon -- --headless --shots 5 --out DIR` runs it without a window and writes a
//! report, a plot and, with `--features render` and `--frames`, pictures.

use std::process::ExitCode;

use clap::Parser;
use drape_examples::arguments::Arguments;
use drape_examples::headless;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match headless::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
