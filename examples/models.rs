//! Writes the files in `assets/models`, made in code as an artist's exports would be: a small character with a cape (skinned,
//! painted and animated; `docs/blender.md` tells what is in it), and a room of furniture.
//!
//! `cargo run --features meshes --example models`

use std::process::ExitCode;

use drape_examples::{character, furniture};

/// Folder of the files.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/models");

fn main() -> ExitCode {
    let models = [("cape.glb", character::gltf_file::model()), ("furniture.glb", furniture::model())];
    for (name, bytes) in models {
        let path = format!("{FOLDER}/{name}");
        if let Err(error) = std::fs::write(&path, bytes) {
            eprintln!("error: {path}: {error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
