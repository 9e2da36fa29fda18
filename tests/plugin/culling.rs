//! Bodies out of sight are culled, and come back as they were.

use bevy::prelude::*;
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::prelude::*;
use bevy_drape::sleep::SceneManager;
use bevy_drape::viewer::Viewer;

use crate::common::*;

fn small_play_area(app: &mut App) {
    let mut manager = app.world_mut().resource_mut::<SceneManager>();
    manager.play_area_min = Vec3::splat(-10.0);
    manager.play_area_max = Vec3::splat(10.0);
}

#[test]
fn a_ball_that_leaves_the_play_area_is_culled_and_goes_on_when_it_is_let_back() {
    let mut app = app();
    weightless(&mut app);
    small_play_area(&mut app);
    let ball = app.world_mut().spawn(Projectile { velocity: Vec3::X * 20.0, ..default() }).id();
    run(&mut app, 0.4);
    assert_eq!(activity(&app, ball), Activity::Active);
    run(&mut app, 1.0);
    assert_eq!(activity(&app, ball), Activity::Culled);
    assert_eq!(counts(&app), (0, 0, 1));
    let place = ball_position(&app, ball).x;
    assert!(place > 10.0 && place < 11.0, "it stands at {place} m, right outside");
    app.world_mut().resource_mut::<SceneManager>().play_area_max = Vec3::splat(1000.0);
    run(&mut app, 1.0);
    assert_eq!(activity(&app, ball), Activity::Active);
    assert!((ball_position(&app, ball).x - place - 20.0).abs() < 0.5);
}

#[test]
fn a_cloth_that_leaves_the_play_area_is_culled_when_it_is_wholly_outside() {
    let mut app = app();
    small_play_area(&mut app);
    let cloth = app.world_mut().spawn((free_cloth(), dragless(), Transform::from_xyz(0.0, -9.0, 0.0))).id();
    for _ in 0..60 {
        step(&mut app, 1);
        let highest = get::<Particles>(&app, cloth).bounds().1.y;
        let is_culled = activity(&app, cloth) == Activity::Culled;
        // The step that takes it outside is the last.
        assert!(!is_culled || highest < -10.0, "culled with its upper edge at {highest} m");
        assert!(is_culled || highest > -10.3, "still simulated with its upper edge at {highest} m");
    }
    assert_eq!(activity(&app, cloth), Activity::Culled);
}

#[test]
fn lost_balls_can_be_despawned() {
    let mut app = app();
    small_play_area(&mut app);
    app.world_mut().resource_mut::<SceneManager>().despawn_lost_balls = true;
    let ball = app.world_mut().spawn(Projectile { velocity: Vec3::X * 50.0, ..default() }).id();
    let cloth = app.world_mut().spawn(free_cloth()).id();
    run(&mut app, 3.0);
    assert!(app.world().get_entity(ball).is_err(), "the ball is gone");
    assert_eq!(activity(&app, cloth), Activity::Culled, "cloths are kept");
}

#[test]
fn balls_that_sleep_far_away_are_not_lost() {
    let mut app = app();
    app.world_mut().resource_mut::<SceneManager>().despawn_lost_balls = true;
    app.world_mut().resource_mut::<SceneManager>().viewer_distance = 5.0;
    app.world_mut().spawn((Viewer, Transform::from_xyz(50.0, 0.0, 0.0)));
    app.world_mut().spawn(Obstacle::ground());
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.15, 0.0))).id();
    run(&mut app, 5.0);
    assert_eq!(activity(&app, ball), Activity::Culled);
}

#[test]
fn a_sleeper_far_from_every_viewer_is_culled_until_one_comes_near() {
    let mut app = app();
    app.world_mut().resource_mut::<SceneManager>().viewer_distance = 10.0;
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    settle(&mut app, curtain);
    step(&mut app, 10);
    assert_eq!(activity(&app, curtain), Activity::Resting, "without viewers nothing is far");

    let viewer =
        |app: &mut App, x: f32| app.world_mut().spawn((Viewer, Transform::from_xyz(x, 0.0, 0.0))).id();
    let near = viewer(&mut app, 9.0);
    let far = viewer(&mut app, -50.0);
    step(&mut app, 2);
    assert_eq!(activity(&app, curtain), Activity::Resting, "one viewer is near");

    let before = hash(&app, &[curtain]);
    get_mut::<Transform>(&mut app, near).translation.x = 12.0;
    step(&mut app, 2);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    assert_eq!(counts(&app), (0, 0, 1));

    get_mut::<Transform>(&mut app, far).translation.x = -8.0;
    step(&mut app, 2);
    assert_eq!(activity(&app, curtain), Activity::Resting);
    assert_eq!(hash(&app, &[curtain]), before, "it sleeps on as it was");
}

#[test]
fn what_moves_far_away_is_simulated() {
    let mut app = app();
    app.world_mut().resource_mut::<SceneManager>().viewer_distance = 10.0;
    app.world_mut().spawn((Viewer, Transform::from_xyz(100.0, 0.0, 0.0)));
    let cloth = app.world_mut().spawn(free_cloth()).id();
    run(&mut app, 1.0);
    assert_eq!(activity(&app, cloth), Activity::Active);
    assert!(centre(&app, cloth).y < -2.0);
}

#[test]
fn a_culled_curtain_is_carried_along_by_its_rail() {
    let mut app = app();
    small_play_area(&mut app);
    let curtain = app.world_mut().spawn((curtain(), quiet(), Transform::from_xyz(50.0, 0.0, 0.0))).id();
    step(&mut app, 5);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    // Back towards the play area, at 60 m/s, and then into it and turned.
    for _ in 0..35 {
        get_mut::<Transform>(&mut app, curtain).translation.x -= 1.0;
        step(&mut app, 1);
    }
    assert_eq!(activity(&app, curtain), Activity::Culled);
    assert!(centre(&app, curtain).distance(Vec3::new(15.0, 0.0, 0.0)) < 0.1, "{}", centre(&app, curtain));
    *get_mut::<Transform>(&mut app, curtain) =
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_rotation_y(0.5));
    run(&mut app, 1.0);
    assert_eq!(activity(&app, curtain), Activity::Active);
    let stretch =
        drape_solver::state::measure::stretch(get::<Particles>(&app, curtain), get::<Sticks>(&app, curtain));
    assert!(stretch.max < 0.01, "it was stretched by {}", stretch.max);
    assert!(centre(&app, curtain).distance(Vec3::new(0.0, 1.0, 0.0)) < 0.1);
}

#[test]
fn a_culled_body_that_is_put_back_comes_back() {
    let mut app = app();
    small_play_area(&mut app);
    let cloth = app.world_mut().spawn((free_cloth(), Transform::from_xyz(50.0, 0.0, 0.0))).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(-50.0, 0.0, 0.0))).id();
    step(&mut app, 5);
    assert_eq!(counts(&app), (0, 0, 2));
    get_mut::<Particles>(&mut app, cloth).translate(Vec3::X * -50.0);
    get_mut::<Transform>(&mut app, ball).translation.x = -3.0;
    run(&mut app, 0.5);
    assert_eq!(counts(&app), (2, 0, 0));
    assert!(centre(&app, cloth).y < -0.5 && centre(&app, cloth).x.abs() < 1e-3);
    assert!(ball_position(&app, ball).y < -0.5);
}

#[test]
fn a_push_on_a_culled_sleeper_acts_when_it_comes_back() {
    let mut app = app();
    app.world_mut().resource_mut::<SceneManager>().viewer_distance = 10.0;
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    settle(&mut app, curtain);
    let viewer = app.world_mut().spawn((Viewer, Transform::from_xyz(50.0, 0.0, 0.0))).id();
    step(&mut app, 2);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    get_mut::<Particles>(&mut app, curtain).apply_impulse(76, Vec3::Z * 0.1);
    step(&mut app, 5);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    get_mut::<Transform>(&mut app, viewer).translation.x = 0.0;
    step(&mut app, 3);
    assert_eq!(activity(&app, curtain), Activity::Active);
    assert!(speed(&app, curtain) > 0.1);
}

#[test]
fn every_state_is_counted() {
    let mut app = app();
    small_play_area(&mut app);
    let at = |x: f32| Transform::from_xyz(x, 0.0, 0.0);
    let rested = app.world_mut().spawn((curtain(), quiet(), at(0.0))).id();
    app.world_mut().spawn((Projectile::default(), at(5.0)));
    app.world_mut().spawn((Rope::default(), quiet(), at(-5.0)));
    settle(&mut app, rested);
    run(&mut app, 1.0);
    app.world_mut().spawn((Projectile { velocity: Vec3::Y * 9.0, ..default() }, at(3.0)));
    app.world_mut().spawn((Projectile { velocity: Vec3::Y * 9.0, ..default() }, at(4.0)));
    app.world_mut().spawn((Projectile { velocity: Vec3::Y * 9.0, ..default() }, at(6.0)));
    run(&mut app, 0.5);
    // Three flying; the curtain and the rope at rest; the first ball far below.
    assert_eq!(counts(&app), (3, 2, 1));
}

#[test]
fn a_scene_manager_of_nonsense_culls_nothing() {
    let mut app = app();
    let mut manager = app.world_mut().resource_mut::<SceneManager>();
    manager.play_area_min = Vec3::NAN;
    manager.play_area_max = Vec3::NAN;
    manager.sleep_time = f32::NAN;
    manager.viewer_distance = f32::NAN;
    app.world_mut().spawn((Viewer, Transform::from_xyz(f32::NAN, 0.0, 0.0)));
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    app.world_mut().spawn(Projectile::default());
    run(&mut app, 3.0);
    assert_eq!(counts(&app), (2, 0, 0));
    app.insert_resource(SceneManager { viewer_distance: f32::NAN, ..default() });
    settle(&mut app, curtain);
    run(&mut app, 1.0);
    assert_eq!(activity(&app, curtain), Activity::Resting);
}

#[test]
fn a_sleeper_comes_back_when_the_far_viewer_is_gone() {
    let mut app = app();
    app.world_mut().resource_mut::<SceneManager>().viewer_distance = 10.0;
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    settle(&mut app, curtain);
    let far = app.world_mut().spawn((Viewer, Transform::from_xyz(50.0, 0.0, 0.0))).id();
    step(&mut app, 2);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    app.world_mut().resource_mut::<SceneManager>().viewer_distance = 100.0;
    step(&mut app, 1);
    assert_eq!(activity(&app, curtain), Activity::Resting, "a hundred metres are far enough to see it");
    app.world_mut().resource_mut::<SceneManager>().viewer_distance = 10.0;
    step(&mut app, 1);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    step(&mut app, 5);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    app.world_mut().entity_mut(far).despawn();
    step(&mut app, 1);
    assert_eq!(activity(&app, curtain), Activity::Resting);
}
