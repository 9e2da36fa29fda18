//! Bodies come with their description, change with it and go with it.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, DefaultBodySurface, Sticks};
use bevy_drape::prelude::*;

use crate::common::*;

#[test]
fn a_body_comes_and_goes_with_its_description() {
    let mut app = app();
    let entity = app.world_mut().spawn(Transform::default()).id();
    step(&mut app, 3);
    assert_eq!(counts(&app), (0, 0, 0));
    app.world_mut().entity_mut(entity).insert(curtain());
    step(&mut app, 3);
    assert_eq!(counts(&app), (1, 0, 0));
    assert_eq!(get::<Particles>(&app, entity).len(), 81);
    assert_eq!(get::<Sticks>(&app, entity).particle_count(), 81);

    app.world_mut().entity_mut(entity).remove::<Cloth>();
    step(&mut app, 3);
    assert_eq!(counts(&app), (0, 0, 0));
    let left = app.world().entity(entity);
    assert!(!left.contains::<Particles>() && !left.contains::<Sticks>() && !left.contains::<Activity>());

    // The same entity may become something else.
    app.world_mut().entity_mut(entity).insert(Rope::default());
    step(&mut app, 3);
    assert_eq!(get::<Particles>(&app, entity).len(), 32);
    app.world_mut().entity_mut(entity).remove::<Rope>().insert(Projectile::default());
    step(&mut app, 3);
    assert!(app.world().get::<Particles>(entity).is_none());
    assert!(ball_position(&app, entity).y < 0.0);
    app.world_mut().entity_mut(entity).remove::<Projectile>();
    step(&mut app, 3);
    assert!(app.world().get::<ProjectileState>(entity).is_none());
    assert_eq!(counts(&app), (0, 0, 0));
}

#[test]
fn the_spacing_of_a_cloth_gives_its_particles() {
    let counts = |spacing| Cloth::new(2.0, 1.5).with_spacing(spacing).particles;
    assert_eq!(counts(0.1), UVec2::new(21, 16));
    assert_eq!(counts(0.4), UVec2::new(6, 5));
    assert_eq!(counts(9.0), UVec2::new(2, 2));
    for bad in [0.0, -1.0, f32::NAN, 1e-12] {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::new(2.0, 1.5).with_spacing(bad)).id();
        step(&mut app, 2);
        assert!(refusals(&app, cloth)[0].contains("particles"), "{bad}: {:?}", refusals(&app, cloth));
    }
}

#[test]
fn a_changed_description_builds_the_body_anew() {
    let mut app = app();
    let entity = app.world_mut().spawn((curtain(), quiet(), Transform::from_xyz(0.0, 3.0, 0.0))).id();
    settle(&mut app, entity);
    get_mut::<Cloth>(&mut app, entity).particles = UVec2::new(5, 7);
    step(&mut app, 1);
    assert_eq!(get::<Particles>(&app, entity).len(), 35);
    assert_eq!(activity(&app, entity), Activity::Active);

    // Inserting over it is a change, too; here it is one to no pins, so that it falls.
    app.world_mut().entity_mut(entity).insert(free_cloth());
    run(&mut app, 1.0);
    assert_eq!(get::<Particles>(&app, entity).len(), 81);
    assert!(centre(&app, entity).y < 2.0, "it falls");
}

#[test]
fn a_changed_projectile_is_launched_anew() {
    let mut app = app();
    weightless(&mut app);
    let ball = app.world_mut().spawn(Projectile { velocity: Vec3::X * 6.0, ..default() }).id();
    run(&mut app, 1.0);
    get_mut::<Projectile>(&mut app, ball).velocity = Vec3::Y * 6.0;
    run(&mut app, 1.0);
    assert!(
        ball_position(&app, ball).distance(Vec3::new(6.0, 6.0, 0.0)) < 1e-3,
        "{}",
        ball_position(&app, ball)
    );
}

#[test]
fn bodies_without_a_surface_use_the_default_one() {
    let fall = |own: Option<BodySurface>, default: BodySurface| {
        let mut app = app();
        app.insert_resource(DefaultBodySurface(default));
        let rope = Rope { pin_start: false, ..Rope::new(Vec3::NEG_X, Vec3::X, 9) };
        let rope = app.world_mut().spawn(rope).id();
        if let Some(own) = own {
            app.world_mut().entity_mut(rope).insert(own);
        }
        run(&mut app, 1.0);
        -centre(&app, rope).y
    };
    let draggy = BodySurface { drag: 20.0, ..default() };
    assert!((fall(None, dragless()) - 0.5 * GRAVITY).abs() < 0.1);
    assert!(fall(None, draggy) < 0.6);
    assert!((fall(Some(dragless()), draggy) - 0.5 * GRAVITY).abs() < 0.1);
}

#[test]
fn a_body_made_by_hand_is_simulated() {
    let mut app = app();
    let (particles, sticks) = Rope::default().build(&GlobalTransform::IDENTITY).expect("a rope");
    // Its own particles and a shared topology; no description.
    let rope = app.world_mut().spawn((Particles(particles), Sticks(sticks))).id();
    app.world_mut().spawn((Obstacle::sphere(0.1), Transform::from_xyz(0.0, -0.5, 0.0)));
    let ball = Projectile { velocity: Vec3::X * 8.0, ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(-1.0, -0.8, 0.0)));
    run(&mut app, 0.5);
    assert!(app.world().resource::<Hits>().0.iter().any(|hit| hit.target == rope), "the ball meets it");
    assert!(get::<Particles>(&app, rope).is_finite());
}

#[test]
fn a_ball_is_moved_by_its_transform_and_flies_on() {
    let mut app = app();
    weightless(&mut app);
    let ball = app.world_mut().spawn(Projectile { velocity: Vec3::X * 3.0, ..default() }).id();
    run(&mut app, 1.0);
    get_mut::<Transform>(&mut app, ball).translation = Vec3::new(0.0, 50.0, 0.0);
    run(&mut app, 1.0);
    assert!(
        ball_position(&app, ball).distance(Vec3::new(3.0, 50.0, 0.0)) < 1e-3,
        "{}",
        ball_position(&app, ball)
    );
}

#[test]
fn a_ball_has_its_transform_in_the_coordinates_of_its_parent() {
    let mut app = app();
    weightless(&mut app);
    let turned = Transform::from_xyz(10.0, 0.0, 0.0)
        .with_rotation(Quat::from_rotation_y(core::f32::consts::FRAC_PI_2))
        .with_scale(Vec3::splat(2.0));
    let parent = app.world_mut().spawn(turned).id();
    let ball = Projectile { velocity: Vec3::X * 4.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(parent))).id();
    run(&mut app, 1.0);
    // In the world from (10, 2, 0) along X; seen by the parent, X is its own +Z, at half the size.
    assert!(
        ball_position(&app, ball).distance(Vec3::new(14.0, 2.0, 0.0)) < 1e-3,
        "{}",
        ball_position(&app, ball)
    );
    let local = get::<Transform>(&app, ball).translation;
    assert!(local.distance(Vec3::new(0.0, 1.0, 2.0)) < 1e-3, "{local}");
}

#[test]
fn a_rolling_ball_turns() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let ball = Projectile { velocity: Vec3::X * 2.0, rolling_resistance: 0.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.15, 0.0))).id();
    run(&mut app, 1.0);
    let state = get::<ProjectileState>(&app, ball);
    let (spin, velocity) = (state.spin(), state.velocity());
    assert!((spin.z + velocity.x / 0.15).abs() < 0.1 * spin.z.abs(), "spin {spin}, velocity {velocity}");
    assert!(get::<Transform>(&app, ball).rotation.angle_between(Quat::IDENTITY) > 0.01);
}
