//! The harness tests itself: every scene in `tests/scenes` is a test of its own.

use std::process::ExitCode;

fn main() -> ExitCode {
    bevy_drape_script::harness::test_scenes("tests/scenes")
}
