//! Settings, gravity and wind that cannot be used are refused with one clear message, and all the rest runs on.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, DefaultSolverSettings};
use bevy_drape::prelude::*;

use crate::common::*;

/// Asserts that a cloth with the component `bad` is refused in these words, and takes part again with `good`.
fn assert_refused_until_mended<C: Component>(bad: C, words: [&str; 2], good: C) {
    let (mut app, entity) = assert_refused((free_cloth(), bad), &words);
    assert_eq!(activity(&app, entity), Activity::Culled);
    app.world_mut().entity_mut(entity).insert(good);
    assert_mended(&mut app, entity);
    assert!(refusals(&app, entity).is_empty(), "a mended body is no longer listed");
}

#[test]
fn settings_out_of_range() {
    let good = SolverSettings::default();
    let bad = [
        (SolverSettings { substeps: 0, ..good }, "substeps"),
        (SolverSettings { substeps: u32::MAX, ..good }, "substeps"),
        (SolverSettings { iterations: 0, ..good }, "iterations"),
    ];
    for (settings, word) in bad {
        assert_refused_until_mended(settings, ["SolverSettings", word], good);
    }
    // The same as the settings of all.
    let mut app = app();
    app.insert_resource(DefaultSolverSettings(SolverSettings { substeps: 0, ..good }));
    let a = app.world_mut().spawn(free_cloth()).id();
    let b = app.world_mut().spawn((free_cloth(), good, Transform::from_xyz(5.0, 0.0, 0.0))).id();
    run(&mut app, 0.5);
    assert_eq!((activity(&app, a), activity(&app, b)), (Activity::Culled, Activity::Active));
    app.insert_resource(DefaultSolverSettings::default());
    assert_mended(&mut app, a);
}

#[test]
fn surfaces_out_of_range() {
    let good = BodySurface::default();
    let bad = [
        (BodySurface { drag: f32::NAN, ..good }, "drag"),
        (BodySurface { drag: -1.0, ..good }, "drag"),
        (BodySurface { friction: f32::INFINITY, ..good }, "friction"),
        (BodySurface { thickness: f32::NAN, ..good }, "thickness"),
    ];
    for (surface, word) in bad {
        assert_refused_until_mended(surface, ["BodySurface", word], good);
    }
}

#[test]
fn gravity_and_wind_that_are_not_finite() {
    for bad in BAD.into_iter().chain([1e30]) {
        let mut app = app();
        let cloth = app.world_mut().spawn((free_cloth(), dragless())).id();
        step(&mut app, 1);
        app.insert_resource(DrapeGravity(Vec3::new(0.0, bad, 0.0)));
        app.world_mut().resource_mut::<Wind>().velocity.x = bad;
        // A ball that is launched meanwhile flies under the last good gravity.
        let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(9.0, 0.0, 0.0))).id();
        run(&mut app, 1.0);
        let messages: Vec<String> =
            app.world().resource::<Refusals>().iter().map(ToString::to_string).collect();
        assert_eq!(messages.len(), 2, "{messages:?}");
        for word in ["DrapeGravity", "Wind"] {
            assert!(messages.iter().any(|message| message.contains(word)), "{messages:?} do not name {word}");
        }
        let fallen = (-centre(&app, cloth).y, -ball_position(&app, ball).y);
        assert!(
            (fallen.0 - 0.5 * GRAVITY).abs() < 0.2 && (fallen.1 - 0.5 * GRAVITY).abs() < 1e-3,
            "{fallen:?}"
        );
        app.insert_resource(DrapeGravity(Vec3::ZERO));
        app.world_mut().resource_mut::<Wind>().velocity.x = 0.0;
        let speed = get::<ProjectileState>(&app, ball).velocity().y;
        run(&mut app, 1.0);
        assert!((get::<ProjectileState>(&app, ball).velocity().y - speed).abs() < 0.2, "weightless again");
        assert!(app.world().resource::<Refusals>().is_empty());
    }
}
