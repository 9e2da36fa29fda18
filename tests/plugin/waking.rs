//! Events that wake a body at rest, and events that do not.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, DefaultSolverSettings, Pressure};
use bevy_drape::clock::DrapeClock;
use bevy_drape::origin::ShiftOrigin;
use bevy_drape::prelude::*;

use crate::common::*;

/// An app with a curtain at rest, pinned at a height of 2 m, and its lower edge at 1 m.
fn sleeping_curtain() -> (App, Entity) {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), quiet(), Transform::from_xyz(0.0, 1.5, 0.0))).id();
    settle(&mut app, curtain);
    run(&mut app, 1.0);
    assert_eq!(activity(&app, curtain), Activity::Resting);
    (app, curtain)
}

/// Asserts that `body` wakes within two steps and then has the time to pick up speed.
fn assert_wakes(app: &mut App, body: Entity) {
    step(app, 2);
    assert_eq!(activity(app, body), Activity::Active, "it sleeps on");
    for _ in 0..30 {
        step(app, 1);
        assert_eq!(activity(app, body), Activity::Active, "it fell asleep again at once");
    }
}

/// Index of the middle of the curtain's lower edge.
const LOWER_EDGE: usize = 8 * 9 + 4;

#[test]
fn a_force_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    let before = centre(&app, curtain);
    get_mut::<Particles>(&mut app, curtain).add_force(LOWER_EDGE, Vec3::Z * 0.5);
    assert_wakes(&mut app, curtain);
    assert!(centre(&app, curtain).distance(before) > 1e-5);
}

#[test]
fn an_impulse_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    get_mut::<Particles>(&mut app, curtain).apply_impulse(LOWER_EDGE, Vec3::Z * 0.01);
    assert_wakes(&mut app, curtain);
}

#[test]
fn a_breeze_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    let before = centre(&app, curtain);
    // Too weak to bring the curtain to the threshold of rest within one step.
    app.world_mut().resource_mut::<Wind>().velocity = Vec3::Z * 0.4;
    assert_wakes(&mut app, curtain);
    run(&mut app, 0.5);
    assert!(centre(&app, curtain).z > before.z + 1e-3, "the wind moves it");
}

#[test]
fn a_change_of_gravity_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    app.insert_resource(DrapeGravity(Vec3::new(0.0, -9.0, 3.0)));
    assert_wakes(&mut app, curtain);
    assert!(speed(&app, curtain) > 0.01);
}

#[test]
fn a_change_of_settings_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    app.world_mut().entity_mut(curtain).insert(SolverSettings { iterations: 4, ..default() });
    assert_wakes(&mut app, curtain);
}

/// It changes how the body is solved.
#[test]
fn to_become_tearable_and_to_be_so_no_longer_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    app.world_mut().entity_mut(curtain).insert(Tearable::default());
    assert_wakes(&mut app, curtain);
    settle(&mut app, curtain);
    step(&mut app, 10);
    app.world_mut().entity_mut(curtain).remove::<Tearable>();
    assert_wakes(&mut app, curtain);
}

#[test]
fn a_change_of_the_default_settings_wakes_bodies_without_their_own() {
    let (mut app, curtain) = sleeping_curtain();
    app.world_mut().resource_mut::<DefaultSolverSettings>().substeps = 4;
    assert_wakes(&mut app, curtain);

    let (mut app, curtain) = sleeping_curtain();
    app.world_mut().entity_mut(curtain).insert(SolverSettings::default());
    settle(&mut app, curtain);
    step(&mut app, 10);
    app.world_mut().resource_mut::<DefaultSolverSettings>().substeps = 4;
    step(&mut app, 10);
    assert_eq!(activity(&app, curtain), Activity::Resting, "this one has settings of its own");
}

#[test]
fn moving_a_particle_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    let mut particles = get_mut::<Particles>(&mut app, curtain);
    let place = particles.position(LOWER_EDGE) + Vec3::Z * 0.05;
    particles.set_position(LOWER_EDGE, place);
    assert_wakes(&mut app, curtain);
}

#[test]
fn letting_go_of_pins_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    let mut particles = get_mut::<Particles>(&mut app, curtain);
    for i in 0..9 {
        particles.set_inverse_mass(i, 100.0);
    }
    assert_wakes(&mut app, curtain);
    assert!(centre(&app, curtain).y < 1.2, "it falls");
}

#[test]
fn moving_the_rail_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    get_mut::<Transform>(&mut app, curtain).translation.x += 0.05;
    assert_wakes(&mut app, curtain);
}

#[test]
fn a_ball_wakes_before_it_touches() {
    let (mut app, curtain) = sleeping_curtain();
    let ball = Projectile { velocity: Vec3::new(0.0, 1.9, 15.0), ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 1.5, -6.0))).id();
    let mut woken_at = None;
    for count in 0..60 {
        step(&mut app, 1);
        if activity(&app, curtain) == Activity::Active && woken_at.is_none() {
            woken_at = Some(count);
            let gap = -0.15 - ball_position(&app, ball).z;
            assert!(gap < 15.0 * STEP + 0.1, "it woke while the ball was {gap} m away");
        }
    }
    let hits = &app.world().resource::<Hits>().0;
    assert_eq!(hits.len(), 1);
    assert_eq!(hits[0].target, curtain);
    // As soon as in the plane of the curtain: 5.85 m at 15 m/s.
    assert!(
        (hits[0].time - app.world().resource::<DrapeClock>().elapsed() + 1.0 - 5.845 / 15.0).abs() < 0.01
    );
    assert!(woken_at.is_some());
    assert!(speed(&app, curtain) > 0.1);
}

#[test]
fn a_ball_that_flies_past_wakes_nothing() {
    let (mut app, curtain) = sleeping_curtain();
    let ball = Projectile { velocity: Vec3::Z * 15.0, ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(1.2, 1.5, -6.0)));
    for _ in 0..60 {
        step(&mut app, 1);
        assert_eq!(activity(&app, curtain), Activity::Resting);
    }
}

#[test]
fn an_obstacle_that_moves_in_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    let obstacle = app.world_mut().spawn((Obstacle::sphere(0.2), Transform::from_xyz(0.0, 1.4, -1.0))).id();
    step(&mut app, 30);
    assert_eq!(activity(&app, curtain), Activity::Resting, "it is too far off");
    for _ in 0..60 {
        get_mut::<Transform>(&mut app, obstacle).translation.z += 1.0 * STEP;
        step(&mut app, 1);
    }
    assert_eq!(activity(&app, curtain), Activity::Active);
    let deepest = get::<Particles>(&app, curtain).positions().map(|p| p.distance(Vec3::new(0.0, 1.4, 0.0)));
    assert!(deepest.fold(f32::INFINITY, f32::min) > 0.195, "it is pushed aside");
}

#[test]
fn a_new_obstacle_wakes() {
    let (mut app, curtain) = sleeping_curtain();
    app.world_mut().spawn((Obstacle::sphere(0.2), Transform::from_xyz(0.0, 1.4, -0.1)));
    assert_wakes(&mut app, curtain);
}

/// A cloth asleep on a table of 1 m, and the table.
fn cloth_on_table() -> (App, Entity, Entity) {
    let mut app = app();
    let table =
        app.world_mut().spawn((Obstacle::cuboid(2.0, 0.1, 2.0), Transform::from_xyz(0.0, 0.95, 0.0))).id();
    let flat = Transform::from_xyz(0.0, 1.02, 0.0)
        .with_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let cloth = app.world_mut().spawn((free_cloth(), quiet(), flat)).id();
    settle(&mut app, cloth);
    (app, cloth, table)
}

#[test]
fn an_obstacle_that_is_taken_away_wakes() {
    let (mut app, cloth, table) = cloth_on_table();
    app.world_mut().entity_mut(table).despawn();
    assert_wakes(&mut app, cloth);
    assert!(centre(&app, cloth).y < 0.9, "it falls");
}

#[test]
fn an_obstacle_that_loses_its_component_is_none_any_more() {
    let (mut app, cloth, table) = cloth_on_table();
    app.world_mut().entity_mut(table).remove::<Obstacle>();
    assert_wakes(&mut app, cloth);
    assert!(centre(&app, cloth).y < 0.9, "it falls");
}

#[test]
fn an_obstacle_that_changes_its_shape_wakes() {
    let (mut app, cloth, table) = cloth_on_table();
    *get_mut::<Obstacle>(&mut app, table) = Obstacle::cuboid(0.1, 0.1, 0.1);
    assert_wakes(&mut app, cloth);
    let mut app = cloth_on_table();
    get_mut::<Transform>(&mut app.0, app.2).scale = Vec3::splat(0.2);
    assert_wakes(&mut app.0, app.1);
}

#[test]
fn an_obstacle_that_lies_still_lets_sleep() {
    let (mut app, cloth, table) = cloth_on_table();
    // Written to, but not changed in place.
    get_mut::<Transform>(&mut app, table).set_changed();
    step(&mut app, 3);
    app.world_mut().spawn((Obstacle::sphere(0.1), Transform::from_xyz(5.0, 0.0, 0.0)));
    step(&mut app, 3);
    assert_eq!(activity(&app, cloth), Activity::Resting);
}

#[test]
fn a_ball_that_rolls_against_another_wakes_it() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let spawn = |app: &mut App, x: f32, velocity: Vec3| {
        let ball = Projectile { rolling_resistance: 0.01, velocity, ..default() };
        app.world_mut().spawn((ball, Transform::from_xyz(x, 0.15, 0.0))).id()
    };
    let (first, second) = (spawn(&mut app, 0.0, Vec3::ZERO), spawn(&mut app, 0.31, Vec3::ZERO));
    settle(&mut app, first);
    settle(&mut app, second);
    let roller = spawn(&mut app, -3.0, Vec3::X * 3.0);
    run(&mut app, 3.0);
    assert!(ball_position(&app, first).x > 0.01, "{}", ball_position(&app, first));
    assert!(ball_position(&app, second).x > 0.4, "{}", ball_position(&app, second));
    let gap = ball_position(&app, first).x - ball_position(&app, roller).x;
    assert!(gap > 0.3 - 1e-3, "the balls overlap: their centres are {gap} m apart");
}

#[test]
fn a_fast_ball_wakes_a_whole_row_at_once() {
    for offset in [0.0, 0.1, 0.2, 0.3] {
        let mut app = app();
        weightless(&mut app);
        let spawn = |app: &mut App, x: f32, velocity: Vec3| {
            app.world_mut()
                .spawn((Projectile { velocity, ..default() }, Transform::from_xyz(x, 0.0, 0.0)))
                .id()
        };
        let row = [0.0, 0.3, 0.6].map(|x| spawn(&mut app, x, Vec3::ZERO));
        for ball in row {
            settle(&mut app, ball);
        }
        spawn(&mut app, -3.0 - offset, Vec3::X * 25.0);
        for _ in 0..30 {
            step(&mut app, 1);
            let [a, b, c] = row.map(|ball| ball_position(&app, ball).x);
            let gap = (b - a).min(c - b) - 0.3;
            assert!(gap > -0.03, "the balls of the row are {gap} m deep in one another");
        }
        assert!(ball_position(&app, row[2]).x > 1.0);
    }
}

#[test]
fn a_sheet_that_is_let_go_wakes_the_ball_on_it() {
    let mut app = app();
    let flat = Transform::from_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let sheet = app.world_mut().spawn((curtain().with_pins(ClothPins::Corners), slippery(), flat)).id();
    let ball = Projectile { mass: 0.2, drag: 3.0, friction: 0.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.2, 0.0))).id();
    settle(&mut app, ball);
    let before = ball_position(&app, ball).y;
    let mut particles = get_mut::<Particles>(&mut app, sheet);
    for corner in [0, 8, 72, 80] {
        particles.set_inverse_mass(corner, 100.0);
    }
    run(&mut app, 0.5);
    assert!(ball_position(&app, ball).y < before - 0.5, "it falls with the sheet");
}

#[test]
fn a_ball_at_rest_is_woken_by_hand() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.15, 0.0))).id();
    settle(&mut app, ball);
    get_mut::<ProjectileState>(&mut app, ball).apply_impulse(Vec3::X * 2.0);
    assert_wakes(&mut app, ball);
    assert!(ball_position(&app, ball).x > 0.2);
    settle(&mut app, ball);
    get_mut::<Transform>(&mut app, ball).translation.y += 2.0;
    assert_wakes(&mut app, ball);
    let height = ball_position(&app, ball).y;
    assert!(height < 1.2 && height > 0.2, "it falls from where it was put: {height}");
}

#[test]
fn the_ground_taken_away_wakes_a_ball() {
    let mut app = app();
    let ground = app.world_mut().spawn(Obstacle::ground()).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.15, 0.0))).id();
    settle(&mut app, ball);
    app.world_mut().entity_mut(ground).despawn();
    assert_wakes(&mut app, ball);
    assert!(ball_position(&app, ball).y < -0.5);
}

#[test]
fn a_surface_that_was_taken_away_long_before_a_step_wake() {
    let (mut app, curtain) = sleeping_curtain();
    // A picture takes a tenth of a step.
    frame_time(&mut app, STEP / 10.0);
    app.world_mut().entity_mut(curtain).remove::<BodySurface>();
    step(&mut app, 25);
    assert_eq!(activity(&app, curtain), Activity::Active);
}

#[test]
fn a_longer_step_lets_a_ball_reach_farther_sleepers() {
    let mut app = app();
    weightless(&mut app);
    let sleeper = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(2.0, 0.0, 0.0))).id();
    settle(&mut app, sleeper);
    // 9 m/s are 0.15 m in a step at full speed, too few to get there; at six times the speed they are 0.9 m.
    let ball = Projectile { velocity: Vec3::X * 9.0, ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(1.0, 0.0, 0.0)));
    step(&mut app, 1);
    assert_eq!(activity(&app, sleeper), Activity::Resting);
    app.world_mut().resource_mut::<DrapeClock>().time_scale = 6.0;
    step(&mut app, 1);
    assert_eq!(activity(&app, sleeper), Activity::Active);
}

#[test]
fn a_ball_wakes_of_many_only_those_in_its_way_also_after_they_slept_again() {
    let mut app = app();
    weightless(&mut app);
    let ropes: Vec<Entity> = (0..60)
        .map(|i| {
            let rope = Rope { particles: 4, ..default() };
            app.world_mut().spawn((rope, quiet(), Transform::from_xyz(i as f32, 0.0, 0.0))).id()
        })
        .collect();
    for crossing in 0..3 {
        run(&mut app, 3.0);
        assert_eq!(counts(&app), (0, ropes.len() - crossing.min(1), 0), "all sleep");
        // Beside the ropes from 9.5 m to 14.9 m, with 0.6 m to where it can get within a step.
        let ball = Projectile { velocity: Vec3::X * 27.0, ..default() };
        let ball = app.world_mut().spawn((ball, Transform::from_xyz(9.5, -0.5, 0.3))).id();
        step(&mut app, 12);
        let is_awake = |i: &usize| {
            let activity = app.world().get::<Activity>(ropes[*i]);
            activity == Some(&Activity::Active)
        };
        let awake: Vec<usize> = (0..ropes.len()).filter(is_awake).collect();
        let expected: Vec<usize> = (9..=15).filter(|&i| i != 12 || crossing == 0).collect();
        assert_eq!(awake, expected, "at crossing {crossing}");
        app.world_mut().entity_mut(ball).despawn();
        if crossing == 0 {
            run(&mut app, 3.0);
            app.world_mut().entity_mut(ropes[12]).despawn();
        }
    }
}

/// A hammock and a ball that lies in it, both asleep.
fn ball_in_a_hammock() -> (App, Entity, Entity) {
    let mut app = app();
    let flat = Transform::from_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let hammock = app.world_mut().spawn((curtain().with_pins(ClothPins::Corners), slippery(), flat)).id();
    let ball = Projectile { mass: 0.2, drag: 3.0, friction: 0.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.2, 0.0))).id();
    settle(&mut app, ball);
    assert_eq!(counts(&app), (0, 2, 0));
    (app, hammock, ball)
}

fn assert_falls(app: &mut App, ball: Entity) {
    let before = ball_position(app, ball).y;
    run(app, 0.5);
    assert!(ball_position(app, ball).y < before - 0.5, "it hangs in the air");
}

/// The ball slept on, with nothing below it.
#[test]
fn what_lay_on_something_that_is_gone_wakes() {
    let (mut app, hammock, ball) = ball_in_a_hammock();
    app.world_mut().despawn(hammock);
    assert_falls(&mut app, ball);

    let (mut app, hammock, ball) = ball_in_a_hammock();
    app.world_mut().entity_mut(hammock).remove::<Cloth>();
    assert_falls(&mut app, ball);

    let (mut app, hammock, ball) = ball_in_a_hammock();
    app.world_mut().despawn(hammock);
    ShiftOrigin(64.0 * Vec3::X).apply(app.world_mut());
    assert_falls(&mut app, ball);
}

/// Sleepers are found where they are in the new coordinates: a ball flew through a curtain that slept.
#[test]
fn what_sleeps_wakes_after_a_shift_of_the_origin() {
    let (mut app, hammock, ball) = ball_in_a_hammock();
    step(&mut app, 5);
    ShiftOrigin(64.0 * Vec3::X).apply(app.world_mut());
    step(&mut app, 5);
    assert_eq!(counts(&app), (0, 2, 0));
    app.world_mut().despawn(hammock);
    assert_falls(&mut app, ball);
}

/// A sleeper that was disabled while its support came and went is found again.
#[test]
fn what_sleeps_wakes_after_it_was_disabled() {
    let mut app = app();
    let table = (Obstacle::cuboid(1.0, 0.1, 1.0), Transform::default());
    let first = app.world_mut().spawn(table.clone()).id();
    let ball = Projectile { radius: 0.1, mass: 1.0, restitution: 0.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.16, 0.0))).id();
    settle(&mut app, ball);
    step(&mut app, 5);
    app.world_mut().entity_mut(ball).insert(Disabled);
    app.world_mut().despawn(first);
    step(&mut app, 5);
    let second = app.world_mut().spawn(table).id();
    step(&mut app, 5);
    app.world_mut().entity_mut(ball).remove::<Disabled>();
    step(&mut app, 5);
    assert_eq!(activity(&app, ball), Activity::Resting);
    app.world_mut().despawn(second);
    assert_falls(&mut app, ball);
}

#[test]
fn what_lay_on_something_that_is_set_down_elsewhere_wakes() {
    let (mut app, hammock, ball) = ball_in_a_hammock();
    get_mut::<Transform>(&mut app, hammock).translation.x = 50.0;
    assert_falls(&mut app, ball);
}

/// Only another pressure woke, and none did not.
#[test]
fn a_balloon_that_loses_its_air_wakes() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let ball = SoftBall::default();
    let place = Transform::from_xyz(0.0, 2.0, 0.0);
    let ball = app.world_mut().spawn((ball, Pressure(1.0), quiet(), place)).id();
    settle(&mut app, ball);
    app.world_mut().entity_mut(ball).remove::<Pressure>();
    step(&mut app, 2);
    assert_eq!(activity(&app, ball), Activity::Active);
}
