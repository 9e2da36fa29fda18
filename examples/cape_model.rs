//! Writes `assets/models/cape.glb`: a small character with a cape, made in code, skinned, painted and animated as an artist's
//! export would be. `docs/blender.md` tells what is in it.
//!
//! `cargo run --features meshes --example cape_model`

use std::process::ExitCode;

use drape_examples::character::gltf_file::model;

/// Path of the file.
const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/models/cape.glb");

fn main() -> ExitCode {
    match std::fs::write(PATH, model()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {PATH}: {error}");
            ExitCode::FAILURE
        }
    }
}
