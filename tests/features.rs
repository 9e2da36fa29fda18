//! Every example of a feature runs without a window: nothing is refused, nothing leaves, nothing flies apart.
#![expect(dead_code, reason = "the examples' own `main`")]

use drape_examples::feature::{Feature, FeatureReport};

/// Faster than the hem of a cloth that a ball of 10 m/s drags through the air like a whip, in m/s.
const TOO_FAST: f32 = 100.0;

/// Examples that are no [`Feature`]s: they have tests of their own.
const OTHERS: [&str; 2] = ["cannon", "scene"];

macro_rules! features {
    ($($name:ident: $path:literal),* $(,)?) => {
        $(#[path = $path] mod $name;)*

        const NAMES: &[&str] = &[$(stringify!($name)),*];

        mod runs {
            $(#[test] fn $name() { super::run(&super::$name::FEATURE); })*
        }
    };
}

features! {
    balloon: "../examples/balloon.rs",
    bridge: "../examples/bridge.rs",
    cloth_mesh: "../examples/cloth_mesh.rs",
    crates: "../examples/crates.rs",
    cut: "../examples/cut.rs",
    drape: "../examples/drape.rs",
    fan: "../examples/fan.rs",
    flag: "../examples/flag.rs",
    folds: "../examples/folds.rs",
    layers: "../examples/layers.rs",
    presets: "../examples/presets.rs",
    ragdoll: "../examples/ragdoll.rs",
    soft_ball: "../examples/soft_ball.rs",
    tear: "../examples/tear.rs",
    trampoline: "../examples/trampoline.rs",
}

fn run(feature: &Feature) -> FeatureReport {
    let report = feature.run_headless(feature.moment).expect("a run without a fault");
    assert!(report.greatest_speed < TOO_FAST, "{report:?}");
    assert!(report.greatest_speed > 0.1, "nothing moves: {report:?}");
    report
}

#[test]
fn every_example_is_run_here_or_elsewhere() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let files = std::fs::read_dir(folder).expect("the examples");
    let paths = files.map(|file| file.expect("a file").path());
    let names = paths.filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    for path in names {
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
        assert!(NAMES.contains(&name) || OTHERS.contains(&name), "{name} is not tried");
    }
}

#[test]
fn a_cut_curtain_is_in_pieces() {
    assert!(run(&cut::FEATURE).bodies >= 2, "what is cut off is a body of its own");
}

#[test]
fn weak_cloth_tears_and_strong_cloth_holds() {
    let report = run(&tear::FEATURE);
    assert_eq!(report.balls, 3);
    assert!(report.particles > 3 * 40 * 40, "no particle was split: {report:?}");
}
