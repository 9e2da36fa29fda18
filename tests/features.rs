//! Every example of a feature runs without a window: nothing is refused, nothing leaves, nothing flies apart.

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::{App, FixedUpdate, Startup, Transform, Update, Vec3};
use bevy_drape::detail::CurrentDetail;
use bevy_drape::prelude::{Attachment, Particles};
use drape_examples::feature::{Feature, FeatureReport, bare_app, steps_in};

#[path = "../examples/showcase.rs"]
#[expect(dead_code, reason = "the examples' own `main`")]
mod showcase;

use showcase::FEATURES;

/// Faster than the hem of a cloth that a ball of 10 m/s drags through the air like a whip, in m/s.
const TOO_FAST: f32 = 100.0;

/// Least simulated time in seconds, so that falling things land even if the picture is taken earlier.
const LEAST_TIME: f32 = 2.2;

/// Examples that are no features of their own, or need a GPU: they have other tests.
const OTHERS: [&str; 6] = ["cannon", "models", "readme", "scene", "showcase", "stadium"];
/// Examples that need the feature `gltf`.
const OF_GLTF: [&str; 2] = ["cape_gltf", "dust_sheets"];

macro_rules! runs {
    ($($(#[$when:meta])? $name:ident),* $(,)?) => {
        /// The examples that are run here.
        const RUN: &[&str] = &[$($(#[$when])? stringify!($name)),*];

        mod runs {
            $($(#[$when])? #[test] fn $name() { super::run(&super::showcase::$name::FEATURE); })*
        }
    };
}

runs! {
    balloon, bones, bridge, bsn, cape, #[cfg(feature = "gltf")] cape_gltf, cloth_mesh, crates, creases, curtain_2d, cut, detail, drag, drape,
    #[cfg(feature = "gltf")] dust_sheets, fabrics, fan, flag,
    folds, jelly, knot, lamps, layers, observers, outfit, presets, ragdoll, rollback, soft_ball, tear, trampoline, winch, wrecking_ball,
}

fn run(feature: &Feature) -> FeatureReport {
    let report = feature.run_headless(feature.picture_time.max(LEAST_TIME)).expect("a run without a fault");
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
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples");
    let files = std::fs::read_dir(folder).expect("the examples");
    let paths = files.map(|file| file.expect("a file").path());
    let names = paths.filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    for path in names {
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
        assert!(
            RUN.contains(&name) || OTHERS.contains(&name) || OF_GLTF.contains(&name),
            "{name} is not tried"
        );
    }
}

#[test]
fn a_cut_curtain_is_in_pieces() {
    assert!(run(&showcase::cut::FEATURE).bodies >= 2, "what is cut off is a body of its own");
}

/// A feature's world at its moment.
fn at_its_moment(feature: &Feature) -> App {
    let mut app = feature.headless_app();
    // The first update takes no step.
    (0..=steps_in(&app, feature.picture_time)).for_each(|_| app.update());
    app
}

/// Of each body, how far `measure` says, the least first.
fn of_bodies(app: &mut App, measure: impl Fn(&Particles) -> f32) -> Vec<f32> {
    let mut found: Vec<f32> = app.world_mut().query::<&Particles>().iter(app.world()).map(measure).collect();
    found.sort_unstable_by(f32::total_cmp);
    found
}

#[test]
fn a_strong_hand_takes_a_curtain_along_and_a_weak_one_does_not() {
    let mut app = at_its_moment(&showcase::drag::FEATURE);
    // The place of both hands by then, but for the side.
    let target = Vec3::new(0.0, 1.3, 0.7);
    let off = |particles: &Particles| {
        particles.positions().map(|place| place.with_x(0.0).distance(target)).fold(f32::INFINITY, f32::min)
    };
    let off = of_bodies(&mut app, off);
    assert!(off[0] < 0.05 && off[1] > 0.1, "without limit, and 0.8 N: {off:?}");
}

#[test]
fn a_knot_holds_only_where_the_rope_touches_itself() {
    let mut app = at_its_moment(&showcase::knot::FEATURE);
    let apart = |particles: &Particles| particles.position(0).distance(particles.position(120));
    let apart = of_bodies(&mut app, apart);
    assert!(apart[0] > 1.7 && apart[0] < 2.1, "a knot of 0.4 m of rope: {apart:?}");
    assert!(apart[1] > 2.3, "{apart:?}");
}

#[test]
fn a_rope_stays_tied_to_both_boats() {
    let mut app = at_its_moment(&showcase::lamps::FEATURE);
    let world = app.world_mut();
    let (particles, ties) = world.query::<(&Particles, &Attachment)>().single(world).expect("one rope");
    let ends = [particles.position(0), particles.position(60)];
    for (tie, end) in ties.ties.iter().zip(ends) {
        let boat = world.get::<Transform>(tie.entity).expect("a boat");
        let top = boat.transform_point(Vec3::Y * 1.65);
        // The knot is one step of the boat behind.
        assert!(end.distance(top) < 0.01, "{end} is not at {top}");
        assert!(top.distance(Vec3::new(top.x.signum() * 1.9, 1.77, 0.0)) > 0.05, "the boat has moved: {top}");
    }
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
