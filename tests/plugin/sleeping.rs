//! Bodies at rest fall asleep, bodies that only turn back do not, and sleepers cost nothing.

use bevy::ecs::change_detection::Tick;
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;
use bevy_drape::sleep::SceneManager;
use drape_solver::constants::REST_SPEED;

use crate::common::*;

#[test]
fn a_curtain_falls_asleep_when_it_has_been_still_for_the_sleep_time() {
    for sleep_time in [0.5, 2.0] {
        let mut app = app();
        app.world_mut().resource_mut::<SceneManager>().sleep_time = sleep_time;
        // Let go a little to the side.
        let tilted = Transform::from_rotation(Quat::from_rotation_x(0.3));
        let curtain = app.world_mut().spawn((curtain(), quiet(), tilted)).id();
        let (mut steps, mut last_motion) = (0, 0);
        while steps == 0 || activity(&app, curtain) != Activity::Resting {
            step(&mut app, 1);
            steps += 1;
            assert!(steps < 3600, "it never fell asleep");
            if speed(&app, curtain) >= REST_SPEED {
                last_motion = steps;
            }
        }
        assert!(last_motion > 10, "it swung before");
        let still_for = (steps - last_motion) as f32 * STEP;
        assert!((still_for - sleep_time).abs() < 2.0 * STEP, "asleep after {still_for} s of {sleep_time} s");
        assert_eq!(counts(&app), (0, 1, 0));
    }
}

#[test]
fn a_swinging_body_does_not_fall_asleep_at_its_turning_points() {
    let mut app = app();
    // A pendulum of 1 m, let go 8 cm to the side: half a period is one second.
    let rope = Rope::new(Vec3::ZERO, Vec3::new(0.08, -1.0, 0.0), 2);
    let rope = app.world_mut().spawn((rope, dragless())).id();
    let (mut turns, mut was_slow) = (0, true);
    for _ in 0..600 {
        step(&mut app, 1);
        assert_eq!(activity(&app, rope), Activity::Active);
        let is_slow = speed(&app, rope) < REST_SPEED;
        turns += usize::from(is_slow && !was_slow);
        was_slow = is_slow;
    }
    assert!(turns >= 4, "it was slower than the threshold at {turns} turning points only");
}

#[test]
fn a_swinging_curtain_swings_on() {
    let mut app = app();
    let tilted = Transform::from_rotation(Quat::from_rotation_x(1.0));
    let curtain = app.world_mut().spawn((curtain(), BodySurface { drag: 0.02, ..default() }, tilted)).id();
    for _ in 0..600 {
        step(&mut app, 1);
        assert_eq!(activity(&app, curtain), Activity::Active);
    }
    assert!(speed(&app, curtain) > REST_SPEED);
}

#[test]
fn a_ball_on_the_ground_falls_asleep() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let ball = Projectile { velocity: Vec3::X, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.5, 0.0))).id();
    settle(&mut app, ball);
    assert!((ball_position(&app, ball).y - 0.15).abs() < 1e-3);
    assert_eq!(counts(&app), (0, 1, 0));
}

#[test]
fn what_lies_in_one_another_sleeps_together() {
    let mut app = app();
    // A trampoline and a ball that lies on it. It is woken by the ball and the ball by it, so none may sleep alone.
    let flat = Transform::from_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let sheet = app.world_mut().spawn((curtain().with_pins(ClothPins::Corners), slippery(), flat)).id();
    let ball = Projectile { mass: 0.2, drag: 3.0, friction: 0.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.2, 0.0))).id();
    for _ in 0..3600 {
        step(&mut app, 1);
        assert_eq!(
            activity(&app, sheet),
            activity(&app, ball),
            "the ball is at {}",
            ball_position(&app, ball)
        );
        if activity(&app, ball) == Activity::Resting {
            break;
        }
    }
    assert_eq!(counts(&app), (0, 2, 0));
    assert!(ball_position(&app, ball).y > -1.0, "it lies in the sheet");
}

#[test]
fn sleeping_can_be_turned_off() {
    let mut app = app();
    app.world_mut().resource_mut::<SceneManager>().sleeping = false;
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    run(&mut app, 10.0);
    assert_eq!(activity(&app, curtain), Activity::Active);
}

#[test]
fn a_body_can_be_put_to_sleep_by_hand() {
    let mut app = app();
    let cloth = app.world_mut().spawn(free_cloth()).id();
    step(&mut app, 1);
    *get_mut::<Activity>(&mut app, cloth) = Activity::Resting;
    let before = hash(&app, &[cloth]);
    step(&mut app, 30);
    assert_eq!(hash(&app, &[cloth]), before, "it hangs in the air, as it was told to");
    *get_mut::<Activity>(&mut app, cloth) = Activity::Active;
    step(&mut app, 1);
    assert_ne!(hash(&app, &[cloth]), before);
}

fn changed_at<C: Component>(app: &App, entity: Entity) -> Tick {
    let ticks = app.world().entity(entity).get_change_ticks::<C>();
    ticks.expect("the component").changed
}

#[test]
fn a_body_at_rest_is_not_touched() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let curtain_at = |x| Transform::from_xyz(x, 2.0, 0.0);
    let sleeper = app.world_mut().spawn((curtain(), quiet(), curtain_at(0.0))).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(-5.0, 0.15, 0.0))).id();
    settle(&mut app, sleeper);
    settle(&mut app, ball);
    // Something else goes on.
    let tilted = curtain_at(5.0).with_rotation(Quat::from_rotation_x(1.0));
    let other = app.world_mut().spawn((curtain(), dragless(), tilted)).id();
    step(&mut app, 1);
    let ticks = |app: &App| {
        [
            changed_at::<Particles>(app, sleeper),
            changed_at::<Activity>(app, sleeper),
            changed_at::<ProjectileState>(app, ball),
            changed_at::<Transform>(app, ball),
            changed_at::<GlobalTransform>(app, ball),
        ]
    };
    let (before, ticks_before) = (hash(&app, &[sleeper, ball]), ticks(&app));
    let other_before = changed_at::<Particles>(&app, other);
    run(&mut app, 3.0);
    assert_eq!(hash(&app, &[sleeper, ball]), before);
    assert_eq!(ticks(&app), ticks_before);
    assert_ne!(changed_at::<Particles>(&app, other), other_before, "the other one is stepped");
    assert_eq!(counts(&app), (1, 2, 0));
}
