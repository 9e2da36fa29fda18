//! Hashes of how scenes end: the same on every machine and instruction set, for any number of threads, in every build.

use std::fs;
use std::path::Path;

use drape_solver::Isa;

use crate::contender::{Contender, Failure};
use crate::drape::{Drape, on_threads, state_hash};
use crate::model::Pins;
use crate::scene::{Scene, SceneKind};
use crate::solver::{Effort, Projection};

/// Steps after which a state is hashed.
const STEPS: usize = 600;

/// The scenes with their sizes, and whether grids solve their lines.
const SCENES: [(SceneKind, u32, bool); 4] = [
    (SceneKind::Sheet, 128, false),
    (SceneKind::Sheet, 64, true),
    (SceneKind::Mesh, 2000, false),
    (SceneKind::Ropes, 10, false),
];

/// A line for each scene: its name, its size, how it is solved, and the hash of its state.
///
/// # Errors
/// [`Failure`] of a scene.
pub fn hashes(isa: Isa, threads: u32) -> Result<String, Failure> {
    let mut text = String::new();
    for (kind, n, lines) in SCENES {
        let scene = Scene::new(kind, n, Pins::Corners)?;
        let projection = if lines { Projection::SquareRootFree } else { Projection::Exact };
        let effort = Effort { threads, projection, lines, isa, ..Effort::default() };
        let positions = on_threads(threads, || {
            let mut drape = Drape::new(&scene, &effort)?;
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
/// [`Failure::Golden`], which says how to renew the file.
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
