//! Pause, single steps and slow motion.

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use crate::common::*;

fn clock(app: &mut App) -> Mut<'_, DrapeClock> {
    app.world_mut().resource_mut::<DrapeClock>()
}

#[test]
fn a_paused_simulation_stands_still_and_steps_one_by_one() {
    let mut app = app();
    let cloth = app.world_mut().spawn(free_cloth()).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    let mut unpaused = hash(&app, &[cloth, ball]);
    step(&mut app, 10);
    clock(&mut app).paused = true;
    let at_pause = hash(&app, &[cloth, ball]);
    assert_ne!(at_pause, unpaused);
    step(&mut app, 10);
    assert_eq!(hash(&app, &[cloth, ball]), at_pause);
    assert_eq!(clock(&mut app).steps(), 10);

    clock(&mut app).step_once();
    clock(&mut app).step_once();
    step(&mut app, 10);
    assert_eq!(clock(&mut app).steps(), 12);
    assert!((clock(&mut app).elapsed() - 12.0 / 60.0).abs() < 1e-6);
    unpaused = hash(&app, &[cloth, ball]);
    assert_ne!(unpaused, at_pause);

    // The pause leaves no trace.
    let mut other = self::app();
    let cloth = other.world_mut().spawn(free_cloth()).id();
    let ball = other.world_mut().spawn((Projectile::default(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    step(&mut other, 12);
    assert_eq!(hash(&other, &[cloth, ball]), unpaused);
}

#[test]
fn a_step_that_was_asked_for_waits_for_the_clock() {
    let mut app = app();
    let mut clock = clock(&mut app);
    (clock.paused, clock.time_scale) = (true, 0.0);
    clock.step_once();
    step(&mut app, 3);
    self::clock(&mut app).time_scale = 1.0;
    step(&mut app, 3);
    assert_eq!(self::clock(&mut app).steps(), 1);
}

#[test]
fn slow_motion_flies_the_same_parabola_slowly() {
    let mut app = app();
    clock(&mut app).time_scale = 0.25;
    let velocity = Vec3::new(3.0, 4.0, 0.0);
    let ball = app.world_mut().spawn(Projectile { velocity, ..default() }).id();
    run(&mut app, 2.0);
    let expected = velocity * 0.5 + Vec3::NEG_Y * (0.5 * GRAVITY * 0.25);
    assert!(ball_position(&app, ball).distance(expected) < 1e-4, "{}", ball_position(&app, ball));
    assert!((clock(&mut app).elapsed() - 0.5).abs() < 1e-6);
}

#[test]
fn changing_the_time_scale_leaves_the_speed_of_a_body_alone() {
    let mut app = app();
    weightless(&mut app);
    let cloth = app.world_mut().spawn((free_cloth(), dragless())).id();
    step(&mut app, 1);
    let mut particles = get_mut::<Particles>(&mut app, cloth);
    for i in 0..particles.len() {
        particles.set_velocity(i, Vec3::X * 3.0);
    }
    for scale in [0.1, 3.0, 0.5] {
        clock(&mut app).time_scale = scale;
        step(&mut app, 20);
    }
    assert!((speed(&app, cloth) - 3.0).abs() < 1e-3, "{}", speed(&app, cloth));
    assert!((centre(&app, cloth).x - 3.0 * 20.0 * 3.6 * STEP).abs() < 0.2, "{}", centre(&app, cloth));
}

#[test]
fn a_time_scale_that_is_no_positive_number_stops_the_simulation() {
    for scale in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut app = app();
        clock(&mut app).time_scale = scale;
        let ball = app.world_mut().spawn(Projectile::default()).id();
        step(&mut app, 10);
        assert_eq!(clock(&mut app).steps(), 0, "at a time scale of {scale}");
        clock(&mut app).time_scale = 1.0;
        step(&mut app, 1);
        assert!(ball_position(&app, ball).y < 0.0);
    }
}

#[test]
fn a_hitch_of_ten_seconds_is_cut_short() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let curtain = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 1.0, 0.0))).id();
    let ball = Projectile { velocity: Vec3::Z * 20.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 1.0, -4.0))).id();
    step(&mut app, 5);
    frame_time(&mut app, 10.0);
    step(&mut app, 1);
    let steps = clock(&mut app).steps();
    assert!((6..=5 + 16).contains(&steps), "Bevy lets at most a quarter of a second pass: {steps} steps");
    step(&mut app, 20);
    assert!(get::<Particles>(&app, curtain).is_finite());
    assert!(ball_position(&app, ball).is_finite());
    assert_eq!(app.world().resource::<Hits>().0.iter().filter(|hit| hit.target == curtain).count(), 1);
}
