//! Every example of a feature runs without a window: nothing is refused, nothing leaves, nothing flies apart.

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::{FixedUpdate, Startup, Transform, Update};
use bevy_drape::prelude::CurrentDetail;
use drape_examples::feature::{Feature, FeatureReport, bare_app};

#[path = "../examples/showcase.rs"]
#[expect(dead_code, reason = "the examples' own `main`")]
mod showcase;

use showcase::FEATURES;

/// Faster than the hem of a cloth that a ball of 10 m/s drags through the air like a whip, in m/s.
const TOO_FAST: f32 = 100.0;

/// Examples that are no features of their own: they have other tests.
const OTHERS: [&str; 4] = ["cannon", "cape_model", "scene", "showcase"];

macro_rules! runs {
    ($($name:ident),* $(,)?) => {
        /// The examples that are run here.
        const RUN: &[&str] = &[$(stringify!($name)),*];

        mod runs {
            $(#[test] fn $name() { super::run(&super::showcase::$name::FEATURE); })*
        }
    };
}

runs! {
    balloon, bridge, cape, cape_gltf, cloth_mesh, crates, curtain_2d, cut, detail, drag, drape, fan, flag,
    folds, jelly, knot, lamps, layers, presets, ragdoll, soft_ball, tear, trampoline, winch,
}

fn run(feature: &Feature) -> FeatureReport {
    let report = feature.run_headless(feature.moment).expect("a run without a fault");
    assert!(report.greatest_speed < TOO_FAST, "{report:?}");
    assert!(report.greatest_speed > 0.1, "nothing moves: {report:?}");
    report
}

#[test]
fn the_showcase_shows_every_example_that_is_run_here() {
    assert!(FEATURES.iter().map(|(name, _)| *name).eq(RUN.iter().copied()));
}

/// The showcase takes the systems of an example into its own world. One that added an asset there closed the window.
#[test]
fn the_showcase_can_take_over_every_example() {
    for (name, feature) in FEATURES {
        let mut app = bare_app();
        let mut schedules = feature.schedules();
        let mut setup = schedules.remove(Startup).unwrap_or_else(|| panic!("{name} sets nothing up"));
        setup.run(app.world_mut());
        for label in [FixedUpdate.intern(), Update.intern()] {
            schedules.remove(label).iter_mut().for_each(|schedule| schedule.run(app.world_mut()));
        }
        assert!(
            app.world_mut().query::<&Transform>().iter(app.world()).count() > 0,
            "{name} has nothing to show"
        );
    }
}

#[test]
fn every_example_is_run_here_or_elsewhere() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let files = std::fs::read_dir(folder).expect("the examples");
    let paths = files.map(|file| file.expect("a file").path());
    let names = paths.filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    for path in names {
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
        assert!(RUN.contains(&name) || OTHERS.contains(&name), "{name} is not tried");
    }
}

#[test]
fn a_cut_curtain_is_in_pieces() {
    assert!(run(&showcase::cut::FEATURE).bodies >= 2, "what is cut off is a body of its own");
}

#[test]
fn a_street_is_seen_at_every_level_of_detail() {
    let mut app = showcase::detail::FEATURE.headless_app();
    (0..30).for_each(|_| app.update());
    let mut levels: Vec<usize> =
        app.world_mut().query::<&CurrentDetail>().iter(app.world()).map(CurrentDetail::level).collect();
    levels.sort_unstable();
    levels.dedup();
    assert_eq!(levels, [0, 1, 2, 3]);
}

#[test]
fn weak_cloth_tears_and_strong_cloth_holds() {
    let report = run(&showcase::tear::FEATURE);
    assert_eq!(report.balls, 3);
    assert!(report.particles > 3 * 40 * 40, "no particle was split: {report:?}");
}
