//! Distant bodies cost less, and no difference is seen.

use bevy::prelude::*;
use bevy_drape::attach::Grab;
use bevy_drape::body::Activity;
use bevy_drape::detail::{CurrentDetail, LevelOfDetail};
use bevy_drape::prelude::*;
use bevy_drape::sleep::ActivityCounts;
use bevy_drape::snapshot::Snapshot;
use bevy_drape::viewer::Viewer;
use drape_solver::state::measure;
use drape_solver::{Backstop, PoseDrive};

use crate::common::*;

/// A flag of 33 x 33 particles by its pole.
fn flag() -> Cloth {
    Cloth::new(1.5, 1.5).with_particles(33, 33).with_pins(ClothPins::Left)
}

/// An app in the wind, with somebody who looks from `distance` metres in front of the origin.
fn app_seen_from(distance: f32) -> (App, Entity) {
    let mut app = app();
    app.insert_resource(Wind::new(Vec3::new(5.0, 0.0, 1.0)));
    let viewer = app.world_mut().spawn((Viewer, Transform::from_xyz(0.0, 0.0, distance))).id();
    (app, viewer)
}

fn look_from(app: &mut App, viewer: Entity, distance: f32) {
    get_mut::<Transform>(app, viewer).translation.z = distance;
}

fn spawn(app: &mut App, bundle: impl Bundle) -> Entity {
    app.world_mut().spawn((bundle, LevelOfDetail::default())).id()
}

fn side(app: &App, body: Entity) -> usize {
    get::<Particles>(app, body).len().isqrt()
}

fn mass(app: &App, body: Entity) -> f64 {
    let particles = get::<Particles>(app, body);
    (0..particles.len())
        .map(|i| f64::from(particles.inverse_mass(i)))
        .filter(|&w| w > 0.0)
        .map(|w| 1.0 / w)
        .sum()
}

#[test]
fn the_farther_away_the_fewer_particles_and_then_none_move() {
    for (distance, level, particles, expected) in [
        (10.0, 0, 33, Activity::Active),
        (30.0, 1, 17, Activity::Active),
        (80.0, 2, 9, Activity::Active),
        (170.0, 3, 9, Activity::Frozen),
        // Drawn still: what waves in the distance does not vanish.
        (400.0, 3, 9, Activity::Frozen),
    ] {
        let (mut app, _) = app_seen_from(distance);
        let flag = spawn(&mut app, flag());
        step(&mut app, 3);
        assert_eq!(get::<CurrentDetail>(&app, flag).level(), level, "from {distance} m");
        assert_eq!(side(&app, flag), particles, "from {distance} m");
        assert_eq!(activity(&app, flag), expected, "from {distance} m");
    }
}

#[test]
fn nobody_looks_so_all_is_done_in_full() {
    let (mut app, viewer) = app_seen_from(80.0);
    let flag = spawn(&mut app, flag());
    step(&mut app, 3);
    assert_eq!(side(&app, flag), 9);
    app.world_mut().despawn(viewer);
    step(&mut app, 2);
    assert_eq!(side(&app, flag), 33);
}

#[test]
fn without_its_levels_a_cloth_is_as_fine_as_it_was() {
    let (mut app, _) = app_seen_from(170.0);
    let flag = spawn(&mut app, flag());
    step(&mut app, 3);
    app.world_mut().entity_mut(flag).remove::<LevelOfDetail>();
    step(&mut app, 2);
    assert_eq!(side(&app, flag), 33);
    assert_eq!(activity(&app, flag), Activity::Active);
}

#[test]
fn a_cloth_that_is_described_anew_far_away_becomes_coarse_again() {
    let (mut app, viewer) = app_seen_from(30.0);
    let flag = spawn(&mut app, flag());
    step(&mut app, 3);
    get_mut::<Cloth>(&mut app, flag).particles = UVec2::splat(65);
    step(&mut app, 3);
    assert_eq!(side(&app, flag), 33);
    look_from(&mut app, viewer, 5.0);
    step(&mut app, 2);
    assert_eq!(side(&app, flag), 65);
}

/// The material is the same: mass, and how far a soft cloth hangs down by its own weight.
#[test]
fn coarse_cloth_weighs_and_stretches_as_fine_cloth_does() {
    let soft = || {
        let fabric = Fabric { stretch_stiffness: 0.99, shear_stiffness: 0.9, ..default() };
        (Cloth::new(1.0, 1.5).with_particles(33, 49), fabric)
    };
    // Solved so well that what is left is the material's.
    let settings = (SolverSettings { tethers: false, substeps: 64, ..default() }, quiet());
    let mut figures = Vec::new();
    for distance in [1.0, 30.0, 80.0] {
        let mut app = app();
        app.world_mut().spawn((Viewer, Transform::from_xyz(0.0, 0.0, distance)));
        let mut detail = LevelOfDetail::default();
        detail.levels.iter_mut().for_each(|level| level.most_substeps = u32::MAX);
        let cloth = app.world_mut().spawn((soft(), settings, detail)).id();
        run(&mut app, 8.0);
        let (low, high) = get::<Particles>(&app, cloth).bounds();
        figures.push((get::<Particles>(&app, cloth).len(), mass(&app, cloth), high.y - low.y));
    }
    let [(fine, _, drop), (coarse, _, coarse_drop), (coarser, _, coarser_drop)] = figures[..] else {
        panic!("three")
    };
    println!("{fine}, {coarse}, {coarser} particles hang {drop}, {coarse_drop}, {coarser_drop} m");
    assert_eq!((fine, coarse, coarser), (33 * 49, 17 * 25, 9 * 13));
    assert!(drop > 1.55, "it stretches: {drop} m");
    for other in [coarse_drop, coarser_drop] {
        // The pinned row weighs half a square, which is more of it the coarser the cloth is.
        assert!(((other - 1.5) / (drop - 1.5) - 1.0).abs() < 0.06, "{other} m instead of {drop} m");
    }
}

#[test]
fn a_free_cloth_keeps_mass_and_momentum_when_it_gets_other_particles() {
    let (mut app, viewer) = app_seen_from(1.0);
    app.insert_resource(Wind::default());
    weightless(&mut app);
    let free = Cloth { pins: ClothPins::None, ..flag() };
    let flag = spawn(&mut app, (free, dragless()));
    step(&mut app, 2);
    {
        let mut particles = get_mut::<Particles>(&mut app, flag);
        for i in 0..particles.len() {
            let place = particles.position(i);
            particles
                .set_velocity(i, Vec3::new(1.0 + place.y, (3.0 * place.x).sin(), 2.0 * place.x * place.y));
        }
    }
    step(&mut app, 1);
    let momentum = |app: &App| {
        let momentum = measure::momentum(get::<Particles>(app, flag));
        Vec3::new(momentum.x as f32, momentum.y as f32, momentum.z as f32)
    };
    let (before, weight) = (momentum(&app), mass(&app, flag));
    for distance in [30.0, 80.0, 10.0] {
        look_from(&mut app, viewer, distance);
        step(&mut app, 2);
        let change = (momentum(&app) - before).length() / before.length();
        assert!(change < 1e-5, "momentum changes by {change} at {distance} m");
        assert!((mass(&app, flag) / weight - 1.0).abs() < 1e-5, "mass at {distance} m");
    }
    assert_eq!(side(&app, flag), 33);
}

#[test]
fn a_frozen_flag_stands_still_goes_along_with_its_pole_and_flies_on() {
    let (mut app, viewer) = app_seen_from(80.0);
    let flag = spawn(&mut app, (flag(), Transform::default()));
    run(&mut app, 1.0);
    look_from(&mut app, viewer, 170.0);
    step(&mut app, 1);
    let frozen = hash(&app, &[flag]);
    run(&mut app, 1.0);
    assert_eq!(hash(&app, &[flag]), frozen, "it moves");
    assert_eq!(app.world().resource::<ActivityCounts>().frozen, 1);
    let before: Vec<Vec3> = get::<Particles>(&app, flag).positions().collect();
    get_mut::<Transform>(&mut app, flag).translation.x += 2.0;
    step(&mut app, 2);
    for (before, now) in before.iter().zip(get::<Particles>(&app, flag).positions()) {
        assert!((now - *before - Vec3::X * 2.0).length() < 1e-4, "{before} went to {now}");
    }
    look_from(&mut app, viewer, 100.0);
    step(&mut app, 2);
    assert_eq!(activity(&app, flag), Activity::Active);
    assert!(speed(&app, flag) > 0.1, "it flies on at {} m/s", speed(&app, flag));
}

#[test]
fn what_rests_sleeps_on_while_the_viewer_walks_off_and_is_fine_again_when_he_is_back() {
    let (mut app, viewer) = app_seen_from(1.0);
    app.insert_resource(Wind::default());
    let curtain = spawn(&mut app, (Cloth::new(1.0, 1.0).with_particles(17, 17), quiet()));
    settle(&mut app, curtain);
    let asleep = hash(&app, &[curtain]);
    for distance in [30.0, 80.0, 170.0, 30.0, 1.0] {
        look_from(&mut app, viewer, distance);
        step(&mut app, 3);
        assert_eq!((activity(&app, curtain), hash(&app, &[curtain])), (Activity::Resting, asleep));
    }
    // Woken far away it becomes coarse, comes to rest, and is fine again from near.
    look_from(&mut app, viewer, 80.0);
    get_mut::<Particles>(&mut app, curtain).rouse();
    settle(&mut app, curtain);
    assert_eq!(side(&app, curtain), 5);
    look_from(&mut app, viewer, 1.0);
    step(&mut app, 2);
    assert_eq!(side(&app, curtain), 17);
    settle(&mut app, curtain);
}

#[test]
fn particles_that_somebody_knows_by_their_index_stay() {
    let (mut app, viewer) = app_seen_from(1.0);
    let post = app.world_mut().spawn(Transform::default()).id();
    let tied = spawn(&mut app, (flag(), Attachment::indices(post, [40])));
    let grabbed = spawn(&mut app, flag());
    let followed = spawn(&mut app, flag());
    let tearable = spawn(&mut app, (flag(), Tearable::default()));
    let unpinned = spawn(&mut app, flag());
    let [limited, stopped, driven] = [(); 3].map(|()| spawn(&mut app, flag()));
    let plain = spawn(&mut app, flag());
    app.world_mut().spawn(FollowParticle::last(followed));
    step(&mut app, 2);
    let grab = Grab::new(get::<Particles>(&app, grabbed), 100, 0.2);
    app.world_mut().entity_mut(grabbed).insert(grab);
    get_mut::<Particles>(&mut app, unpinned).set_inverse_mass(0, 500.0);
    get_mut::<Particles>(&mut app, limited).set_motion_limit(9, Vec3::ZERO, 5.0);
    let backstop = Backstop { distance: 0.0, radius: 0.1 };
    let stop = get_mut::<Particles>(&mut app, stopped).set_backstop(9, Vec3::NEG_Y * 5.0, Vec3::Y, backstop);
    let drive = PoseDrive { angular_frequency: 0.1, damping_ratio: 1.0 };
    let drive = get_mut::<Particles>(&mut app, driven).set_pose_drive(9, Vec3::ZERO, drive);
    assert_eq!((stop, drive), (Ok(()), Ok(())));
    look_from(&mut app, viewer, 80.0);
    step(&mut app, 3);
    for (body, name) in [
        (tied, "tied"),
        (grabbed, "grabbed"),
        (followed, "followed"),
        (tearable, "tearable"),
        (unpinned, "unpinned"),
        (limited, "limited"),
        (stopped, "stopped"),
        (driven, "driven"),
    ] {
        assert_eq!(side(&app, body), 33, "{name}");
        assert_eq!(get::<CurrentDetail>(&app, body).level(), 2, "fewer substeps are taken: {name}");
    }
    assert_eq!(side(&app, plain), 9);
    app.world_mut().entity_mut(grabbed).remove::<Grab>();
    step(&mut app, 2);
    assert_eq!(side(&app, grabbed), 9, "when it is let go");
}

#[test]
fn a_viewer_who_is_set_down_elsewhere_sees_the_nearest_flags_first() {
    let (mut app, viewer) = app_seen_from(80.0);
    let at = |i: usize| Transform::from_xyz(0.0, 0.0, -0.1 * i as f32);
    let flags: Vec<Entity> = (0..20).map(|i| spawn(&mut app, (flag(), at(i)))).collect();
    step(&mut app, 10);
    assert!(flags.iter().all(|&flag| side(&app, flag) == 9));
    look_from(&mut app, viewer, 2.0);
    let fine = |app: &App| flags.iter().filter(|&&flag| side(app, flag) == 33).count();
    for expected in [8, 16, 20] {
        step(&mut app, 1);
        assert_eq!(fine(&app), expected);
        assert!(flags[..expected].iter().all(|&flag| side(&app, flag) == 33), "the nearest first");
    }
}

/// A quick save far away, a quick load near by.
#[test]
fn a_snapshot_brings_back_the_particles_that_there_were() {
    let (mut app, viewer) = app_seen_from(80.0);
    let flag = spawn(&mut app, (flag(), Transform::default()));
    run(&mut app, 0.5);
    let saved = Snapshot::take(app.world_mut());
    run(&mut app, 0.5);
    let after = hash(&app, &[flag]);
    look_from(&mut app, viewer, 1.0);
    run(&mut app, 0.5);
    assert_eq!(side(&app, flag), 33);
    look_from(&mut app, viewer, 80.0);
    saved.restore(app.world_mut()).expect("the same scene");
    assert_eq!(side(&app, flag), 9);
    run(&mut app, 0.5);
    assert_eq!(hash(&app, &[flag]), after);
}

#[test]
fn levels_that_make_no_sense_are_named_and_all_is_done_in_full() {
    let (mut app, _) = app_seen_from(80.0);
    let bad = app.world_mut().spawn((flag(), LevelOfDetail { importance: -1.0, ..default() })).id();
    step(&mut app, 3);
    let messages = refusals(&app, bad);
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].contains("LevelOfDetail") && messages[0].contains("importance"), "{messages:?}");
    assert_eq!(side(&app, bad), 33);
    get_mut::<LevelOfDetail>(&mut app, bad).importance = 1.0;
    step(&mut app, 3);
    assert_eq!(refusals(&app, bad), [""; 0]);
    assert_eq!(side(&app, bad), 9);
}

/// Only a viewer that moved, or a body that did of itself, was looked at.
#[test]
fn what_is_carried_up_to_a_viewer_comes_to_life() {
    let (mut app, _) = app_seen_from(170.0);
    let flag = spawn(&mut app, flag());
    let lamp = app.world_mut().spawn(FollowParticle::index(flag, 0)).id();
    step(&mut app, 3);
    assert_eq!(activity(&app, flag), Activity::Frozen);
    get_mut::<Transform>(&mut app, flag).translation.z = 10.0;
    step(&mut app, 2);
    let pole = get::<Particles>(&app, flag).position(0);
    assert!((pole.z - 10.0).abs() < 1e-3, "{pole}");
    assert!(
        get::<Transform>(&app, lamp).translation.distance(pole) < 1e-3,
        "what follows it is carried along"
    );
    get_mut::<Transform>(&mut app, flag).translation.z = 165.0;
    step(&mut app, 4);
    assert_eq!(get::<CurrentDetail>(&app, flag).level(), 0);
    assert_eq!(activity(&app, flag), Activity::Active);
}
