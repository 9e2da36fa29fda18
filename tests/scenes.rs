//! Every scene in `assets/scenes` as a test of its own: `cargo test --test scenes curtain` runs those with `curtain` in
//! their names.

use std::process::ExitCode;

fn main() -> ExitCode {
    bevy_drape_script::harness::test_scenes("assets/scenes")
}
