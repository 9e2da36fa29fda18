//! Hashes of the final states of scenes: equal on every machine and instruction set, for any number of threads, in
//! every build.

use std::fs;
use std::path::Path;

use drape_solver::Isa;

use crate::failure::Failure;
use crate::scenes::model::Pins;
use crate::scenes::scene::{Scene, SceneKind};
use crate::solvers::drape::{Drape, state_hash};
use crate::solvers::options::{Projection, SolverOptions};
use crate::solvers::simulation::Simulation;
use crate::solvers::threads::on_threads;

/// Steps after which a state is hashed.
const STEPS: usize = 600;

/// The scenes with their sizes, and true for those that solve lines directly.
const SCENES: [(SceneKind, u32, bool); 4] = [
    (SceneKind::Sheet, 128, false),
    (SceneKind::Sheet, 64, true),
    (SceneKind::Mesh, 2000, false),
    (SceneKind::Ropes, 10, false),
];

/// One line per scene: its name, its size, the method for structural sticks, and the hash of its state.
///
/// # Errors
/// [`Failure`] of a scene.
pub fn hashes(isa: Isa, threads: u32) -> Result<String, Failure> {
    let mut text = String::new();
    for (kind, n, lines) in SCENES {
        let scene = Scene::new(kind, n, Pins::Corners)?;
        let projection = if lines { Projection::SquareRootFree } else { Projection::Exact };
        let options = SolverOptions { threads, projection, lines, isa, ..SolverOptions::default() };
        let positions = on_threads(threads, || {
            let mut drape = Drape::new(&scene, &options)?;
            for _ in 0..STEPS {
                drape.step()?;
            }
            Ok::<_, Failure>(drape.positions())
        })??;
        let solved = if lines { "lines" } else { "sweeps" };
        text += &format!("{} {n} {solved} {:016x}\n", kind.name(), state_hash(&positions));
    }
    Ok(text)
}

/// Compares `hashes` with those in the file.
///
/// # Errors
/// [`Failure::Golden`], which explains how to renew the file.
pub fn compare(hashes: &str, file: &Path) -> Result<(), Failure> {
    let golden = fs::read_to_string(file).unwrap_or_default();
    if golden == hashes {
        return Ok(());
    }
    Err(Failure::Golden { file: file.display().to_string(), golden, hashes: hashes.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(isa: Isa, threads: u32) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/golden.hashes");
        let hashes = hashes(isa, threads).expect("all scenes run");
        if let Err(failure) = compare(&hashes, &file) {
            panic!("{failure}\non {} with {threads} threads", isa.name());
        }
    }

    #[test]
    fn every_instruction_set_ends_in_the_golden_bits() {
        for isa in Isa::available() {
            check(isa, 1);
        }
    }

    #[test]
    fn every_number_of_threads_ends_in_the_golden_bits() {
        for threads in [2, 3, 8] {
            check(Isa::detected(), threads);
        }
    }
}
