//! The bench program with solvers from crates.io beside this project's.

mod rapier;
mod silk;
mod verlet;

use std::process::ExitCode;

use drape_bench::solver::{OWN, Solver};

/// The peers.
///
/// - `silk`: bevy_silk's solver, called without Bevy around it.
/// - `verlet`: bevy_verlet in an app of its own; its systems are private.
/// - `rapier100`, `rapier1000`: rapier3d's soft bodies with a softness of 100 Hz and 1000 Hz.
const PEERS: &[Solver] = &[
    Solver {
        name: "silk",
        has_threads: false,
        load: |scene, options| Ok(Box::new(silk::Silk::new(scene, options)?)),
    },
    Solver {
        name: "verlet",
        has_threads: false,
        load: |scene, options| Ok(Box::new(verlet::Verlet::new(scene, options)?)),
    },
    Solver {
        name: "rapier100",
        has_threads: false,
        load: |scene, options| Ok(Box::new(rapier::Rapier::new(scene, options, 100.0)?)),
    },
    Solver {
        name: "rapier1000",
        has_threads: false,
        load: |scene, options| Ok(Box::new(rapier::Rapier::new(scene, options, 1000.0)?)),
    },
];

fn main() -> ExitCode {
    drape_bench::main_with(&[OWN, PEERS].concat())
}
