//! Restitution: balls against each other and against obstacles.

use drape_solver::glam::Vec3;
use drape_solver::{BallMaterial, Environment, Island, Placement, Shape};

use crate::common::*;

const COEFFICIENTS: [f32; 4] = [0.0, 0.3, 0.7, 1.0];

fn bouncy(radius: f32, mass: f32, restitution: f32) -> BallMaterial {
    BallMaterial { restitution, ..smooth(radius, mass) }
}

/// Newton's law: the ratio of normal speeds after and before is the coefficient, for all masses and angles. The tangential
/// motion continues, momentum is kept, and kinetic energy does not rise.
#[test]
fn balls_part_as_fast_as_their_restitution_has_it() {
    for restitution in COEFFICIENTS {
        for (mass, offset) in [(1.0, 0.0), (1.0, 0.15), (5.0, 0.1)] {
            let first = ball(bouncy(0.2, mass, restitution), Vec3::new(-1.0, offset, 0.0), Vec3::X * 4.0);
            let second = ball(bouncy(0.1, 1.0, restitution), Vec3::X * 0.5, Vec3::NEG_X * 2.0);
            let mut island = Island::of_ball(first);
            island.balls.push(second);
            let (before, energy) = (momentum(&island), kinetic_energy(&island));
            // Long enough for the hit, too short for the balls to turn about each other.
            let environment = weightless(1e-4);
            while island.touches.is_empty() {
                drape_solver::step(&mut island, &environment).expect("a good step");
            }
            let normal = island.touches[0].normal;
            run(&mut island, &environment, 2e-4);
            let approach = -(Vec3::X * 6.0).dot(normal);
            let apart = (island.balls[0].velocity() - island.balls[1].velocity()).dot(normal);
            let error = (apart - restitution * approach).abs() / approach;
            assert!(
                error < 0.02 * restitution + 1e-3,
                "{apart} m/s after {approach} m/s: {restitution}, {mass} kg"
            );
            assert!((momentum(&island) - before).length() < 1e-5 * before.length());
            assert!(kinetic_energy(&island) <= energy * (1.0 + 1e-5));
        }
    }
}

/// S17: the step continues after the contact: by its end the ball is on its way back, and its motion along the wall is
/// complete.
#[test]
fn a_bounce_takes_place_within_the_step() {
    for restitution in COEFFICIENTS {
        for dt in [1.0 / 30.0, FRAME, 1.0 / 100.0] {
            let velocity = Vec3::new(3.0, 0.0, -7.0);
            let mut island = Island::of_ball(ball(bouncy(0.3, 2.0, restitution), Vec3::Z * 2.0, velocity));
            let wall = obstacle(Shape::HalfSpace { normal: Vec3::Z }, Vec3::ZERO, 0.0);
            let wall = wall.with_restitution(restitution).expect("valid");
            let environment = Environment { obstacles: vec![wall].into(), ..weightless(dt) };
            let hit = (2.0 - 0.3) / 7.0;
            run_with(&mut island, &environment, 0.5, |island, index| {
                let time = (index + 1) as f32 * dt;
                let height =
                    if time < hit { 2.0 - 7.0 * time } else { 0.3 + restitution * 7.0 * (time - hit) };
                let expected = Vec3::new(3.0 * time, 0.0, height);
                let off = island.balls[0].position().distance(expected);
                assert!(off < 2e-3, "{restitution}: {off} m off at {time} s");
            });
        }
    }
}

/// A racket that moves towards the ball adds its own speed to the ball.
#[test]
fn a_moving_wall_strikes_back() {
    let mut island = Island::of_ball(ball(bouncy(0.2, 1.0, 1.0), Vec3::Z * 1.0, Vec3::NEG_Z * 3.0));
    let shape = Shape::Cuboid { half_extents: Vec3::new(2.0, 2.0, 0.5) };
    let wall = obstacle(shape, Vec3::NEG_Z * 1.5, 0.0).with_restitution(1.0).expect("valid");
    let mut environment = Environment { obstacles: vec![wall].into(), ..weightless(FRAME) };
    for index in 1..=40 {
        let place = Placement::at(Vec3::Z * (2.0 * FRAME * index as f32 - 1.5));
        environment.obstacles[0].move_to(place, FRAME);
        drape_solver::step(&mut island, &environment).expect("a good step");
    }
    assert!((island.balls[0].velocity().z - 7.0).abs() < 0.02 * 7.0, "{}", island.balls[0].velocity());
}

/// A dropped ball bounces to the square of its restitution times its height, and comes to rest in the end.
#[test]
fn a_bouncing_ball_comes_to_rest() {
    let restitution = 0.8;
    let mut island = Island::of_ball(ball(bouncy(0.1, 1.0, restitution), Vec3::Y * 1.1, Vec3::ZERO));
    let ground = obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::ZERO, 0.5);
    let ground = ground.with_restitution(restitution).expect("valid");
    let environment = Environment { obstacles: vec![ground].into(), ..gravity(1.0 / 240.0) };
    let (mut has_hit, mut highest) = (false, 0.0_f32);
    run_with(&mut island, &environment, 1.0, |island, _| {
        has_hit |= !island.touches.is_empty();
        if has_hit {
            highest = highest.max(island.balls[0].position().y - 0.1);
        }
    });
    assert_close("height of the first bounce", highest.into(), f64::from(restitution * restitution), 0.02);
    run(&mut island, &environment, 6.0);
    assert!(island.balls[0].velocity().length() < 0.05, "at rest: {}", island.balls[0].velocity());
    assert!((island.balls[0].position().y - 0.1).abs() < 1e-3);
}

/// Two floors in the same place throw a ball back as one does. The second once pulled when the first had thrown the ball
/// faster; its friction then took a negative push, and the ball became NaN.
#[test]
fn a_second_floor_in_the_same_place_does_not_pull() {
    for speed in [20.0, 40_000.0] {
        let fall = |floors: usize| {
            let mut island =
                Island::of_ball(ball(bouncy(1e-3, 1e-3, 0.0), Vec3::Y * 0.1, Vec3::NEG_Y * speed));
            let floor = obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::ZERO, 5.0);
            let floor = floor.with_restitution(0.5).expect("valid");
            let environment = Environment { obstacles: vec![floor; floors].into(), ..weightless(FRAME) };
            run(&mut island, &environment, 0.1);
            island.balls[0].velocity().y
        };
        let (one, two) = (fall(1), fall(2));
        assert!((two - one).abs() < 1e-3 * one, "{one} m/s from one floor, {two} m/s from two");
        assert!((one - 0.25 * speed).abs() < 0.02 * one, "{one} m/s after {speed} m/s");
    }
}
