//! S17: the time and place of first contact, interpolated within the step.

use drape_solver::glam::Vec3;
use drape_solver::motion::ballistics::position_at;
use drape_solver::{Ball, BodySettings, ClothBuilder, Environment, Island, Obstacle, Other, Shape};

use crate::common::*;

/// Time from the start and ball centre of the first touch within `seconds`.
fn first_touch(island: &mut Island, environment: &Environment, seconds: f32) -> (f64, Vec3, Other) {
    let mut found = None;
    run_with(island, environment, seconds, |island, index| {
        if let (None, Some(touch)) = (found, island.touches.first()) {
            let time = f64::from(environment.dt) * index as f64 + f64::from(touch.time);
            found = Some((time, touch.ball_position, touch.other));
        }
    });
    found.expect("a touch")
}

fn shot(velocity: Vec3, dt: f32) -> Island {
    let launched = Ball::launch(smooth(0.15, 2.0), Vec3::Y * 2.0, velocity, Vec3::NEG_Y * G, dt);
    Island::of_ball(launched.expect("valid"))
}

/// S17: a ball meets a wall when and where the closed form says.
#[test]
fn a_ball_meets_a_wall_when_the_closed_form_says() {
    for speed in [12.0, 18.5, 25.0] {
        for dt in [1.0 / 30.0, FRAME, 1.0 / 100.0] {
            let velocity = Vec3::new(1.0, 4.0, -speed);
            let mut island = shot(velocity, dt);
            let wall = obstacle(Shape::HalfSpace { normal: Vec3::Z }, Vec3::Z * -10.0, 0.0);
            let environment = Environment { obstacles: vec![wall].into(), ..gravity(dt) };
            let (time, place, other) = first_touch(&mut island, &environment, 1.0);
            let expected = (10.0 - 0.15) / f64::from(speed);
            assert_close("time of contact", time, expected, 0.01);
            let down = Vec3::NEG_Y * G;
            let closed =
                position_at(Vec3::Y.as_dvec3() * 2.0, velocity.as_dvec3(), down.as_dvec3(), expected);
            assert!((place.as_dvec3() - closed).length() < 0.01, "{place} and not {closed}");
            assert_eq!(other, Other::Obstacle(0));
        }
    }
}

/// S17: a ball meets a curtain a thickness before its plane.
#[test]
fn a_ball_meets_a_curtain_when_the_closed_form_says() {
    for speed in [12.0, 25.0] {
        let velocity = Vec3::new(0.0, 4.0, -speed);
        let mut island = shot(velocity, FRAME);
        // Without gravity and with a pinned rim, so that it stays in its plane.
        let settings = BodySettings { drag: 50.0, ..BodySettings::default() };
        let curtain = ClothBuilder::new(4.0, 4.0, 33, 33)
            .placed(Vec3::new(-2.0, 4.0, -10.0), Vec3::X, Vec3::NEG_Y)
            .pin_where(|column, row, _| column % 32 == 0 || row % 32 == 0)
            .build(settings)
            .expect("valid");
        island.bodies.push(curtain);
        let (time, place, other) = first_touch(&mut island, &gravity(FRAME), 1.0);
        let expected = (10.0 - 0.155) / f64::from(speed);
        assert_close("time of contact", time, expected, 0.01);
        let down = Vec3::NEG_Y * G;
        let start = Vec3::Y * 2.0;
        let closed = position_at(start.as_dvec3(), velocity.as_dvec3(), down.as_dvec3(), expected);
        assert!((place.as_dvec3() - closed).length() < 0.01, "{place} and not {closed}");
        assert_eq!(other, Other::Body(0));
    }
}

/// Two balls head on: contact at half the gap, and each touch names the other.
#[test]
fn two_balls_meet_half_way() {
    let material = smooth(0.2, 1.0);
    let mut island = Island::of_ball(ball(material, Vec3::X * -2.0, Vec3::X * 5.0));
    island.balls.push(ball(material, Vec3::X * 2.0, Vec3::X * -5.0));
    let (time, place, _) = first_touch(&mut island, &weightless(FRAME), 1.0);
    assert_close("time of contact", time, 1.8 / 5.0, 0.01);
    assert!((place - Vec3::X * -0.2).length() < 0.01, "{place}");
}

/// The impulses reported over a hit add up to the momentum that the ball lost.
#[test]
fn the_reported_impulse_is_the_change_of_momentum() {
    let mut island = shot(Vec3::NEG_Z * 10.0, FRAME);
    let wall = obstacle(Shape::HalfSpace { normal: Vec3::Z }, Vec3::Z * -3.0, 0.0);
    let environment = Environment { obstacles: vec![wall].into(), ..weightless(FRAME) };
    let mut impulse = 0.0;
    run_with(&mut island, &environment, 0.5, |island, _| {
        impulse += island.touches.iter().map(|touch| touch.impulse).sum::<f32>();
    });
    assert_close("impulse", impulse.into(), 20.0, 1e-3);
}

/// A ball at rest on the ground touches it in every step, with the impulse of its weight.
#[test]
fn a_resting_ball_weighs_on_the_ground() {
    let mut island = Island::of_ball(ball(smooth(0.15, 2.0), Vec3::Y * 0.15, Vec3::ZERO));
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    run(&mut island, &environment, 0.5);
    run_with(&mut island, &environment, 0.5, |island, _| {
        let [touch] = island.touches[..] else { panic!("one touch a step, but {:?}", island.touches) };
        assert_close("weight", f64::from(touch.impulse / FRAME), f64::from(2.0 * G), 0.01);
        assert!((touch.normal - Vec3::Y).length() < 1e-5);
        assert!((touch.point - Vec3::ZERO).length() < 1e-3);
    });
}
