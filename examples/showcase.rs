//! All examples of features in one window: pick one, and change how it is solved while it runs.
//!
//! `cargo run --release --example showcase --features window`
//!
//! | keys | |
//! |---|---|
//! | left and right, or the list | the example before, the next |
//! | R | from the beginning |
//! | sliders | substeps, iterations, gravity, wind, pace |
//! | G | strain of the sticks |
//! | F | record pictures into `target/showcase`, thirty for each second and without what is written over them, until F again |
//! | P, O, T | pause, one step, slow motion |
//! | left mouse button, right mouse button, wheel | drag, turn, zoom |
//! | H | help on the screen |
//! | Esc | quit |
//!
//! `--headless` runs all of them without a window, with `--features meshes` at least (with `gltf`, those of glTF files too), and prints the result of each.

use std::process::ExitCode;

use drape_examples::feature::Feature;

macro_rules! features {
    ($($(#[$when:meta])? $name:ident: $path:literal),* $(,)?) => {
        $($(#[$when])? #[path = $path] pub mod $name;)*

        /// The examples and their names.
        pub const FEATURES: &[(&str, Feature)] = &[$($(#[$when])? (stringify!($name), $name::FEATURE)),*];
    };
}

features! {
    balloon: "balloon.rs",
    bones: "bones.rs",
    bridge: "bridge.rs",
    bsn: "bsn.rs",
    cape: "cape.rs",
    #[cfg(feature = "gltf")]
    cape_gltf: "cape_gltf.rs",
    cloth_mesh: "cloth_mesh.rs",
    crates: "crates.rs",
    creases: "creases.rs",
    curtain_2d: "curtain_2d.rs",
    cut: "cut.rs",
    detail: "detail.rs",
    drag: "drag.rs",
    drape: "drape.rs",
    #[cfg(feature = "gltf")]
    dust_sheets: "dust_sheets.rs",
    fabrics: "fabrics.rs",
    fan: "fan.rs",
    flag: "flag.rs",
    folds: "folds.rs",
    jelly: "jelly.rs",
    knot: "knot.rs",
    lamps: "lamps.rs",
    layers: "layers.rs",
    observers: "observers.rs",
    outfit: "outfit.rs",
    presets: "presets.rs",
    ragdoll: "ragdoll.rs",
    rollback: "rollback.rs",
    soft_ball: "soft_ball.rs",
    tear: "tear.rs",
    trampoline: "trampoline.rs",
    winch: "winch.rs",
    wrecking_ball: "wrecking_ball.rs",
}

/// Runs it.
pub fn main() -> ExitCode {
    #[cfg(feature = "window")]
    if !std::env::args().any(|argument| argument == "--headless") {
        return match drape_examples::showcase::window::open(FEATURES) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("error: {error}");
                ExitCode::FAILURE
            }
        };
    }
    let mut verdict = ExitCode::SUCCESS;
    for (name, feature) in FEATURES {
        match feature.run_headless(feature.picture_time) {
            Ok(report) => println!(
                "{name}: {} bodies, {} particles, {} balls",
                report.bodies, report.particles, report.balls
            ),
            Err(error) => {
                eprintln!("{name}: {error}");
                verdict = ExitCode::FAILURE;
            }
        }
    }
    verdict
}
