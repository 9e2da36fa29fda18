//! Level of detail: fewer substeps, then none.

use bevy_drape::body::{Activity, SolverSettings};
use bevy_drape::detail::{CurrentDetail, DetailLevel, LevelOfDetail};
use bevy_drape::viewer::Viewer;

use crate::*;

/// Levels of a distance, the most substeps, and true for frozen.
fn levels<const N: usize>(levels: [(f32, u32, bool); N]) -> LevelOfDetail {
    let level =
        |(distance, most_substeps, frozen)| DetailLevel { distance, most_substeps, frozen, ..default() };
    LevelOfDetail { levels: levels.map(level).to_vec(), ..default() }
}

/// The corner of a sheet that is pinned, in its entity's coordinates.
const CORNER: Vec3 = Vec3::new(-0.5, 0.5, 0.0);

/// Brings an entity to a place, for two frames.
fn carry(app: &mut App, body: Entity, place: Vec3) {
    app.world_mut().entity_mut(body).insert(Transform::from_translation(place));
    run(app, 2);
}

/// The greatest way of a particle in so many frames.
fn greatest_way(app: &mut App, body: Entity, frames: usize) -> f32 {
    let before = positions(app, body);
    run(app, frames);
    before.iter().zip(&positions(app, body)).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn a_body_far_from_all_viewers_is_frozen_and_goes_on_when_one_comes() {
    let mut app = app();
    let viewer = app.world_mut().spawn((Viewer, Transform::default())).id();
    let flag = spawn(&mut app, (swinging(), levels([(20.0, 8, true)])));
    run(&mut app, 8);
    assert!(is_on_gpu(&app, flag) && greatest_way(&mut app, flag, 4) > 0.01);
    app.world_mut().entity_mut(viewer).insert(Transform::from_xyz(0.0, 0.0, 50.0));
    run(&mut app, 2);
    assert_eq!(app.world().get::<Activity>(flag), Some(&Activity::Frozen));
    assert_eq!(greatest_way(&mut app, flag, 10), 0.0, "it is frozen");

    // It is carried to the viewer, and thaws there.
    let there = Vec3::new(0.0, 0.0, 45.0);
    carry(&mut app, flag, there);
    assert_eq!(app.world().get::<Activity>(flag), Some(&Activity::Active));
    assert!(positions(&app, flag)[0].distance(there + CORNER) < 1e-4, "its pin is there");
    assert!(greatest_way(&mut app, flag, 10) > 0.01, "it swings");
    assert!(is_on_gpu(&app, flag));

    app.world_mut().entity_mut(viewer).insert(Transform::default());
    run(&mut app, 4);
    assert_eq!(app.world().get::<Activity>(flag), Some(&Activity::Frozen));
    // There are more frames than steps.
    app.world_mut().entity_mut(flag).remove::<LevelOfDetail>();
    (0..12).for_each(|_| frame(&mut app, 0.25));
    assert_eq!(
        app.world().get::<Activity>(flag),
        Some(&Activity::Active),
        "without levels it is solved in full"
    );
}

/// A body that was carried a few metres while it was frozen was once pulled there in one step, and frozen again in the next.
#[test]
fn a_body_that_was_carried_while_frozen_goes_on_where_it_is() {
    let mut app = app();
    app.world_mut().spawn((Viewer, Transform::default()));
    let flag = spawn(&mut app, (swinging(), levels([(20.0, 8, true)]), Transform::from_xyz(0.0, 0.0, 24.0)));
    run(&mut app, 4);
    assert_eq!(app.world().get::<Activity>(flag), Some(&Activity::Frozen));
    carry(&mut app, flag, Vec3::new(0.0, 0.0, 16.0));
    for _ in 0..10 {
        run(&mut app, 1);
        assert_eq!(app.world().get::<Activity>(flag), Some(&Activity::Active));
    }
    let places = positions(&app, flag);
    assert!(places[0].distance(Vec3::new(0.0, 0.0, 16.0) + CORNER) < 1e-4);
    let width = (1..9).map(|i| places[i].distance(places[i - 1])).sum::<f32>();
    assert!((width - 1.0).abs() < 0.05, "its upper edge is {width} m long");
}

/// The body that comes back to the processor is where its entity is, in its shape.
#[test]
fn a_frozen_body_comes_back_where_its_entity_is() {
    let mut app = app();
    let viewer = app.world_mut().spawn((Viewer, Transform::default())).id();
    let flag = spawn(&mut app, (swinging(), levels([(20.0, 8, true)])));
    run(&mut app, 10);
    app.world_mut().entity_mut(viewer).insert(Transform::from_xyz(0.0, 0.0, 90.0));
    run(&mut app, 2);
    let before = positions(&app, flag);
    let way = Vec3::new(3.0, 0.0, 1.0);
    carry(&mut app, flag, way);
    assert_eq!(positions(&app, flag), before, "it is frozen");
    app.world_mut().entity_mut(flag).remove::<SolveOnGpu>();
    let after = positions(&app, flag);
    assert!(before.iter().zip(&after).all(|(before, after)| (*before + way).distance(*after) < 1e-5));
}

/// A cloth by the thousand, far away, once went there coarse, and stayed so.
#[test]
fn a_distant_cloth_goes_to_the_gpu_in_full() {
    let mut app = app();
    app.world_mut().spawn((Viewer, Transform::from_xyz(0.0, 0.0, 70.0)));
    let cloth = Cloth::new(1.0, 1.0).with_particles(17, 17);
    let flag = spawn(&mut app, (cloth, LevelOfDetail::default()));
    run(&mut app, 3);
    assert!(is_on_gpu(&app, flag));
    assert_eq!(positions(&app, flag).len(), 17 * 17);
    assert_eq!(app.world().get::<CurrentDetail>(flag).expect("a level").level(), 2);
}

/// A sheet with four substeps stretches more than one with sixteen.
#[test]
fn a_distant_body_has_fewer_substeps() {
    let mut app = app();
    let viewer = app.world_mut().spawn((Viewer, Transform::from_xyz(0.0, 0.0, 10.0))).id();
    // Tethers would hide it.
    let settings = |substeps| SolverSettings { substeps, iterations: 1, tethers: false, ..default() };
    let sheet = || Cloth::new(1.0, 1.0).with_particles(15, 15);
    let [full, few] = [16, 4].map(|substeps| spawn(&mut app, (sheet(), settings(substeps))));
    let by_level = spawn(&mut app, (sheet(), settings(16), levels([(5.0, 4, false)])));
    let lowest = |app: &App, body| positions(app, body).iter().map(|place| place.y).fold(9.0, f32::min);
    run(&mut app, 120);
    assert_eq!(app.world().get::<CurrentDetail>(by_level).expect("a level").level(), 1);
    let [of_full, of_few, of_level] = [full, few, by_level].map(|body| lowest(&app, body));
    assert!(of_full - of_few > 2e-3, "{of_full} and {of_few}");
    assert!((of_level - of_few).abs() < 0.2 * (of_full - of_few), "{of_level} is not {of_few}");

    app.world_mut().entity_mut(viewer).insert(Transform::default());
    run(&mut app, 240);
    assert_eq!(app.world().get::<CurrentDetail>(by_level).expect("a level").level(), 0);
    let [of_full, of_level] = [full, by_level].map(|body| lowest(&app, body));
    assert!((of_level - of_full).abs() < 0.2 * (of_full - of_few), "{of_level} is not {of_full}");
}
