//! Cannons fire when they are told to, from the muzzle and at the muzzle speed.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::cannon::{Cannon, FireCannon};
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use crate::common::*;

fn fire(app: &mut App, cannon: Entity) {
    app.world_mut().write_message(FireCannon { cannon });
}

#[test]
fn the_ball_leaves_the_muzzle_with_the_muzzle_velocity() {
    let mut app = app();
    let cannon = Cannon {
        elevation: 0.5,
        azimuth: 0.3,
        muzzle_speed: 18.0,
        barrel_length: 1.5,
        ball: Projectile { mass: 3.0, radius: 0.1, velocity: Vec3::splat(99.0), ..default() },
    };
    let cannon = app.world_mut().spawn((cannon, Transform::from_xyz(4.0, 1.0, -2.0))).id();
    fire(&mut app, cannon);
    step(&mut app, 1);
    let shots = app.world().resource::<Shots>().0.clone();
    assert_eq!(shots.len(), 1);
    assert_eq!(shots[0].cannon, cannon);
    let ball = shots[0].projectile;
    assert_eq!(get::<ProjectileState>(&app, ball).material().mass, 3.0);

    // Forward is -Z; the azimuth turns to the left, which is -X.
    let (up, flat) = (libm::sinf(0.5), libm::cosf(0.5));
    let direction = Vec3::new(-libm::sinf(0.3) * flat, up, -libm::cosf(0.3) * flat);
    let (start, velocity) = (Vec3::new(4.0, 1.0, -2.0) + direction * 1.5, direction * 18.0);
    for count in 1..=60 {
        let t = count as f32 * STEP;
        let expected = start + velocity * t + 0.5 * Vec3::NEG_Y * GRAVITY * t * t;
        let position = ball_position(&app, ball);
        assert!(position.distance(expected) < 1e-3, "after {t} s at {position}, expected {expected}");
        step(&mut app, 1);
    }
    assert_eq!(app.world().resource::<Shots>().0.len(), 1, "one message is one shot");
}

#[test]
fn a_cannon_turns_with_what_carries_it() {
    let mut app = app();
    weightless(&mut app);
    let turned = Quat::from_rotation_y(-core::f32::consts::FRAC_PI_2);
    let ship = app.world_mut().spawn((Transform::from_xyz(10.0, 0.0, 0.0).with_rotation(turned),));
    let ship = ship.id();
    let cannon = Cannon { muzzle_speed: 6.0, barrel_length: 1.0, ..default() };
    let cannon = app.world_mut().spawn((cannon, Transform::from_xyz(0.0, 2.0, 0.0), ChildOf(ship))).id();
    fire(&mut app, cannon);
    run(&mut app, 1.0);
    let ball = app.world().resource::<Shots>().0[0].projectile;
    // The ship looks along +X.
    let position = ball_position(&app, ball);
    assert!(position.distance(Vec3::new(17.0, 2.0, 0.0)) < 1e-3, "{position}");
}

#[test]
fn two_messages_are_two_balls() {
    let mut app = app();
    let a = app.world_mut().spawn((Cannon::default(), Transform::from_xyz(-5.0, 0.0, 0.0))).id();
    let b = app.world_mut().spawn((Cannon::default(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    fire(&mut app, a);
    fire(&mut app, b);
    step(&mut app, 2);
    let shots = app.world().resource::<Shots>().0.clone();
    assert_eq!(shots.iter().map(|shot| shot.cannon).collect::<Vec<_>>(), [a, b]);
    assert_eq!(counts(&app), (2, 0, 0));
}

/// It was lost: messages are forgotten after two ticks.
#[test]
fn a_shot_in_a_pause_is_fired_after_it() {
    let mut app = app();
    let cannon = app.world_mut().spawn(Cannon::default()).id();
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    fire(&mut app, cannon);
    step(&mut app, 5);
    assert!(app.world().resource::<Shots>().0.is_empty());
    app.world_mut().resource_mut::<DrapeClock>().paused = false;
    step(&mut app, 2);
    assert_eq!(app.world().resource::<Shots>().0.len(), 1);
}
