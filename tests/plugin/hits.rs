//! Balls tell what they hit, once for each touch, with the moment of it.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::contact::{BallHit, HitTarget};
use bevy_drape::prelude::*;

use crate::common::*;

fn ball(velocity: Vec3) -> Projectile {
    Projectile { radius: 0.15, mass: 2.0, velocity, ..default() }
}

fn hits(app: &App) -> Vec<BallHit> {
    app.world().resource::<Hits>().0.clone()
}

#[test]
fn a_wall_is_hit_when_and_where_geometry_says() {
    let mut app = app();
    weightless(&mut app);
    let wall = Transform::from_xyz(3.5, 0.0, 0.0);
    let wall = app.world_mut().spawn((Obstacle::cuboid(1.0, 4.0, 4.0), wall)).id();
    let ball = app.world_mut().spawn(ball(Vec3::X * 10.0)).id();
    run(&mut app, 1.0);
    let hits = hits(&app);
    assert_eq!(hits.len(), 1, "{hits:?}");
    let hit = hits[0];
    assert_eq!((hit.projectile, hit.target, hit.kind), (ball, wall, HitTarget::Obstacle));
    // The wall's face is at 3 m, the ball's radius is 0.15 m.
    assert!((hit.time - 0.285).abs() < 1e-5, "{}", hit.time);
    assert!(hit.ball_position.distance(Vec3::X * 2.85) < 1e-4, "{}", hit.ball_position);
    assert!(hit.ball_velocity.distance(Vec3::X * 10.0) < 1e-3, "{}", hit.ball_velocity);
    assert!(hit.point.distance(Vec3::X * 3.0) < 1e-3, "{}", hit.point);
    assert!(hit.normal.distance(Vec3::NEG_X) < 1e-4, "{}", hit.normal);
    // Restitution is zero: the wall takes all of the 20 kg m/s.
    assert!((hit.impulse - 20.0).abs() < 0.1, "{}", hit.impulse);
}

#[test]
fn a_cloth_is_hit_and_takes_momentum() {
    let mut app = app();
    weightless(&mut app);
    let cloth = app.world_mut().spawn((free_cloth(), dragless(), Transform::from_xyz(0.0, 0.0, 2.0))).id();
    let ball = app.world_mut().spawn(ball(Vec3::Z * 12.0)).id();
    run(&mut app, 0.3);
    let hits = hits(&app);
    assert_eq!(hits.len(), 1, "{hits:?}");
    assert_eq!((hits[0].projectile, hits[0].target, hits[0].kind), (ball, cloth, HitTarget::Body));
    let surface = get::<BodySurface>(&app, cloth);
    let expected = f64::from((2.0 - 0.15 - surface.thickness) / 12.0);
    assert!((hits[0].time - expected).abs() < 1e-4, "{} s, expected {expected} s", hits[0].time);
    let particles = get::<Particles>(&app, cloth);
    let taken = drape_solver::state::measure::momentum(particles).z;
    let left = 2.0 * f64::from(get::<ProjectileState>(&app, ball).velocity().z);
    assert!(taken > 0.5, "the cloth took {taken} kg m/s");
    assert!((taken + left - 24.0).abs() < 24.0 * 1e-4, "{taken} + {left} kg m/s");
}

#[test]
fn two_balls_that_meet_each_tell_it_once() {
    let mut app = app();
    weightless(&mut app);
    let a = app.world_mut().spawn(ball(Vec3::X * 5.0)).id();
    let b = app.world_mut().spawn((ball(Vec3::X * -5.0), Transform::from_xyz(4.3, 0.0, 0.0))).id();
    run(&mut app, 1.0);
    let hits = hits(&app);
    let pairs: Vec<_> = hits.iter().map(|hit| (hit.projectile, hit.target)).collect();
    assert_eq!(pairs, [(a, b), (b, a)]);
    for hit in &hits {
        assert_eq!(hit.kind, HitTarget::Projectile);
        // The surfaces are 4 m apart, and close in at 10 m/s.
        assert!((hit.time - 0.4).abs() < 1e-4, "{}", hit.time);
        assert!(hit.normal.dot(hit.ball_velocity) < -4.9, "the normal is towards the ball: {hit:?}");
    }
}

#[test]
fn a_lasting_touch_is_one_hit_through_sleep_and_waking() {
    let mut app = app();
    let ground = app.world_mut().spawn(Obstacle::ground()).id();
    let ball = ball(Vec3::X * 0.5);
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 1.0, 0.0))).id();
    settle(&mut app, ball);
    assert_eq!(hits(&app).len(), 1);
    assert_eq!(hits(&app)[0].target, ground);
    // A nudge along the ground is no new touch.
    run(&mut app, 1.0);
    get_mut::<ProjectileState>(&mut app, ball).apply_impulse(Vec3::X * 0.2);
    run(&mut app, 0.5);
    assert_eq!(hits(&app).len(), 1, "{:?}", hits(&app));
    // A jump is.
    get_mut::<ProjectileState>(&mut app, ball).apply_impulse(Vec3::Y * 6.0);
    run(&mut app, 1.0);
    assert_eq!(hits(&app).len(), 2, "{:?}", hits(&app));
}

#[test]
fn a_ball_that_misses_tells_nothing() {
    let mut app = app();
    weightless(&mut app);
    app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 0.0, 2.0)));
    app.world_mut().spawn((ball(Vec3::Z * 12.0), Transform::from_xyz(0.67, 0.0, 0.0)));
    run(&mut app, 0.5);
    assert!(hits(&app).is_empty(), "{:?}", hits(&app));
}

#[test]
fn a_fast_cloth_does_not_pass_through_a_still_ball() {
    let mut app = app();
    weightless(&mut app);
    let cloth = app.world_mut().spawn((free_cloth(), dragless(), Transform::from_xyz(0.0, 0.0, -3.0))).id();
    let ball = app.world_mut().spawn(ball(Vec3::ZERO)).id();
    step(&mut app, 1);
    let mut particles = get_mut::<Particles>(&mut app, cloth);
    for i in 0..particles.len() {
        particles.set_velocity(i, Vec3::Z * 40.0);
    }
    run(&mut app, 0.25);
    let velocity = get::<ProjectileState>(&app, ball).velocity();
    assert!(velocity.z > 1.0, "the cloth of 40 m/s left the ball with {velocity}");
}
