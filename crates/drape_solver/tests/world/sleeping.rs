//! Bodies at rest fall asleep, and then cost nothing.

use drape_solver::constants::REST_SPEED;
use drape_solver::glam::Vec3;
use drape_solver::{Activity, ActivityCounts, Ball, BallMaterial, BodySettings, ClothBuilder, World};

use crate::common::*;

#[test]
fn a_curtain_falls_asleep_when_it_has_been_still_for_the_sleep_time() {
    for sleep_time in [0.5, 2.0] {
        let mut world = World::new();
        world.rules.sleep_time = sleep_time;
        let id = world.add_body(curtain(Vec3::ZERO));
        world.body_mut(id).expect("it is there").particles.apply_impulse(LOWER_EDGE, Vec3::Z * 0.1);
        let (mut steps, mut last_motion) = (0, 0);
        while world.activity(id) == Some(Activity::Active) {
            world.step().expect("a good step");
            steps += 1;
            assert!(steps < 3600, "it never fell asleep");
            if world[id].particles.mean_square_speed() >= REST_SPEED * REST_SPEED {
                last_motion = steps;
            }
        }
        assert!(last_motion > 10, "it swung before");
        let still_for = (steps - last_motion) as f32 * world.dt;
        assert!(
            (still_for - sleep_time).abs() < 2.0 * world.dt,
            "asleep after {still_for} s of {sleep_time} s"
        );
        assert_eq!(world.events().slept, [id.into()]);
    }
}

#[test]
fn a_sleeper_does_not_move_and_is_in_no_island() {
    let (mut world, curtain) = sleeping_curtain();
    let before = hash(&world[curtain]);
    let ball = world.add_ball(ball(Vec3::X * 50.0, Vec3::ZERO));
    for _ in 0..120 {
        world.step().expect("a good step");
        assert_eq!(world.island_count(), 1, "the ball's only");
        assert!(world.events().woken.is_empty() && world.events().slept.is_empty());
    }
    assert_eq!(hash(&world[curtain]), before);
    assert_eq!(world.counts(), ActivityCounts { active: 1, resting: 1, ..ActivityCounts::default() });
    assert!(world[ball].position().y < -10.0, "the ball falls");
    world.remove_ball(ball);
    world.step().expect("a good step");
    assert_eq!(world.island_count(), 0);
    assert_eq!(hash(&world[curtain]), before);
}

#[test]
fn what_lies_in_one_another_sleeps_together() {
    let mut world = World::new();
    let settings = BodySettings { drag: 4.0, friction: 0.0, ..BodySettings::default() };
    let trampoline = ClothBuilder::new(1.0, 1.0, 9, 9)
        .placed(Vec3::new(-0.5, 0.0, -0.5), Vec3::X, Vec3::Z)
        .pin(0)
        .pin(8)
        .pin(72)
        .pin(80)
        .build(settings)
        .expect("valid");
    let trampoline = world.add_body(trampoline);
    let material = BallMaterial { mass: 0.2, drag: 3.0, friction: 0.0, ..BallMaterial::default() };
    let ball = world.add_ball(Ball::new(material, Vec3::Y * 0.2, Vec3::ZERO).expect("valid"));
    for _ in 0..3600 {
        world.step().expect("a good step");
        assert_eq!(world.activity(trampoline), world.activity(ball));
        if world.activity(ball) == Some(Activity::Resting) {
            break;
        }
    }
    assert_eq!(world.counts().resting, 2);
    assert!(world[ball].position().y > -1.0, "it lies in the sheet");
}

#[test]
fn sleeping_can_be_turned_off_and_put_on_by_hand() {
    let mut world = World::new();
    world.rules.sleeping = false;
    let curtain = world.add_body(curtain(Vec3::ZERO));
    steps(&mut world, 600);
    assert_eq!(world.activity(curtain), Some(Activity::Active));
    let falling = world.add_body(sheet(Vec3::Y * 5.0));
    assert!(world.set_activity(falling, Activity::Resting));
    let before = hash(&world[falling]);
    steps(&mut world, 30);
    assert_eq!(hash(&world[falling]), before, "it hangs in the air, as it was told to");
    world.set_activity(falling, Activity::Active);
    steps(&mut world, 1);
    assert_ne!(hash(&world[falling]), before);
}

#[test]
fn a_clone_goes_on_with_the_same_bits() {
    let mut world = on_ground();
    let curtain = world.add_body(curtain(Vec3::Y * 2.0));
    world.add_ball(ball(Vec3::new(0.0, 1.5, -1.0), Vec3::Z * 5.0));
    steps(&mut world, 10);
    let mut other = world.clone();
    steps(&mut world, 200);
    steps(&mut other, 200);
    assert_eq!(hash(&world[curtain]), hash(&other[curtain]));
    assert_eq!(world.counts(), other.counts());
}
