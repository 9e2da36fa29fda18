//! What lies on itself comes to rest: folds, stacks and piles fall asleep within seconds.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{
    Body, BodySettings, ClothBuilder, Environment, Island, Obstacle, RopeBuilder, SelfContact, step,
};

use crate::common::*;

/// Seconds below the speed of rest after which bodies fall asleep.
const STILL: f32 = 1.0;

fn settings(thickness: f32) -> BodySettings {
    BodySettings { thickness, self_contact: SelfContact::On, ..BodySettings::default() }
}

/// Seconds until the bodies have been still for long enough to fall asleep, at most `limit`.
fn seconds_to_sleep(bodies: Vec<Body>, limit: f32) -> Option<f32> {
    let mut island = Island { bodies, ..Island::default() };
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    let steps = (limit / FRAME) as usize;
    let slept = (1..=steps).find(|_| {
        step(&mut island, &environment).expect("valid");
        island.bodies.iter().all(|body| body.still_for() >= STILL)
    });
    slept.map(|steps| steps as f32 * FRAME)
}

fn assert_sleeps(what: &str, bodies: Vec<Body>, limit: f32) {
    let slept = seconds_to_sleep(bodies, limit);
    println!("{what} sleeps after {slept:?} s");
    assert!(slept.is_some(), "{what} is awake after {limit} s");
}

/// A level sheet above the ground, turned about the vertical.
fn level(height: f32, turn: f32, thickness: f32) -> Body {
    let turn = Quat::from_rotation_y(turn);
    let (right, down) = (turn * Vec3::X, turn * Vec3::Z);
    ClothBuilder::new(0.5, 0.5, 17, 17)
        .placed(Vec3::Y * height - 0.25 * (right + down), right, down)
        .build(settings(thickness))
        .expect("valid")
}

/// Layers never slept: contacts hold up in each substep what it is about to lower, which leaves a speed of some centimetres a
/// second that moves nothing.
#[test]
fn a_fold_falls_asleep() {
    let sheet = ClothBuilder::new(0.8, 0.8, 25, 25)
        .placed(Vec3::new(-0.4, 0.85, 0.0), Vec3::X, Vec3::new(0.0, -0.995, 0.0998))
        .build(settings(0.005))
        .expect("valid");
    assert_sleeps("the fold", vec![sheet], 6.0);
}

/// What has touched in an island is forgotten when other bodies are in it. A body without self-contact was judged by the places of
/// the bodies before it, and one that is larger than they were panicked.
#[test]
fn a_body_comes_to_rest_alike_in_an_island_in_which_others_have_touched() {
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    for side in [9, 17, 33] {
        let alone = || {
            let sheet = ClothBuilder::new(0.5, 0.5, side, side).placed(Vec3::Y * 0.006, Vec3::X, Vec3::Z);
            sheet.build(BodySettings::default()).expect("valid")
        };
        let mut used =
            Island { bodies: vec![level(0.01, 0.0, 0.005), level(0.019, 0.3, 0.005)], ..Island::default() };
        for _ in 0..10 {
            step(&mut used, &environment).expect("valid");
        }
        assert!(used.self_contact_counts().pairs > 0, "they touch");
        used.bodies = vec![alone()];
        let mut fresh = Island::of_body(alone());
        for index in 0..30 {
            for island in [&mut used, &mut fresh] {
                step(island, &environment).expect("valid");
            }
            let [one, other] = [&used, &fresh].map(|island| island.bodies[0].still_for());
            assert_eq!(one, other, "{side}: at step {index}");
        }
        assert!(fresh.bodies[0].still_for() > 0.0, "it lies still");
    }
}

#[test]
fn a_stack_falls_asleep() {
    let sheets = (0..5).map(|k| level(0.05 + 0.03 * k as f32, 0.1 * k as f32, 0.005));
    assert_sleeps("the stack", sheets.collect(), 6.0);
}

#[test]
fn a_pile_of_ropes_falls_asleep() {
    let rope = |k: u32| {
        let turn = Quat::from_rotation_y(0.8 * k as f32);
        let start = Vec3::Y * (0.05 + 0.04 * k as f32) - turn * Vec3::X * 0.3;
        RopeBuilder::new(start, start + turn * Vec3::X * 0.6, 25).build(settings(0.01)).expect("valid")
    };
    assert_sleeps("the pile", (0..6).map(rope).collect(), 6.0);
}

#[test]
fn a_towel_over_a_rope_falls_asleep() {
    let rope = RopeBuilder::new(Vec3::new(-0.5, 1.0, 0.0), Vec3::new(0.5, 1.0, 0.0), 33)
        .pin_start()
        .pin_end()
        .build(settings(0.008))
        .expect("valid");
    assert_sleeps("the towel", vec![rope, level(1.05, 0.0, 0.005)], 7.0);
}
