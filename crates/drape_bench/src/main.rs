//! The bench program: see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    drape_bench::main_with(drape_bench::solver::OWN)
}
