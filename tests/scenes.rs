//! Every scene in `assets/scenes` as a test of its own: `cargo test -p drape_tests --test scenes curtain` runs those with
//! `curtain` in their names. Each has to end in the state of `golden/scenes.hashes`, to the bit.

use std::process::ExitCode;

fn main() -> ExitCode {
    bevy_drape_script::harness::test_scenes_to_the_bit("../assets/scenes", "golden/scenes.hashes")
}
