//! The measure of stillness by which bodies fall asleep.

use drape_solver::glam::Vec3;
use drape_solver::{BallMaterial, BodySettings, ClothBuilder, Edge, Environment, Island, Obstacle};

use crate::common::*;

/// The time in seconds for which a body and a ball that drift at `speed` m/s count as still after two seconds.
fn still_for(speed: f32) -> [f32; 2] {
    let mut body = loose(&[Vec3::ZERO, Vec3::X], bare());
    (0..2).for_each(|i| body.particles.set_velocity(i, Vec3::Y * speed));
    let mut island = Island::of_body(body);
    island.balls.push(ball(smooth(0.1, 1.0), Vec3::Z * 5.0, Vec3::X * speed));
    run(&mut island, &weightless(FRAME), 2.0);
    [island.bodies[0].still_for(), island.balls[0].still_for()]
}

/// The bound is two centimetres a second: 1.5 times that is motion, half of it is rest, from the first step on.
#[test]
fn what_drifts_slower_than_two_centimetres_a_second_is_still() {
    for seconds in still_for(0.01) {
        law("seconds of rest at 1 cm/s", seconds.into(), 2.0, 0.02);
    }
    for seconds in still_for(0.03) {
        law_of_error("seconds of rest at 3 cm/s", seconds.into(), 0.0);
    }
}

/// A swinging curtain is not still for long at its turning points, and is still in the end.
#[test]
fn a_curtain_is_still_when_it_has_swung_out_and_not_where_it_turns() {
    let settings = BodySettings { drag: 1.0, ..BodySettings::default() };
    let curtain = ClothBuilder::new(1.0, 1.0, 9, 9).placed(Vec3::ZERO, Vec3::X, Vec3::new(0.0, -0.8, 0.6));
    let mut island = Island::of_body(curtain.pin_edge(Edge::Top).build(settings).expect("valid"));
    let mut longest = 0.0_f32;
    run_with(&mut island, &gravity(FRAME), 4.0, |island, _| {
        longest = longest.max(island.bodies[0].still_for());
    });
    assert!(longest < 0.5, "it swings, but was taken to be still for {longest} s");
    run(&mut island, &gravity(FRAME), 16.0);
    assert!(island.bodies[0].still_for() > 1.0, "it has swung out: {} s", island.bodies[0].still_for());
}

/// A ball that has rolled to a stop is still.
#[test]
fn a_ball_that_has_rolled_out_is_still() {
    let material = BallMaterial { rolling_resistance: 0.1, ..BallMaterial::default() };
    let mut island = Island::of_ball(ball(material, Vec3::Y * material.radius, Vec3::X));
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    run(&mut island, &environment, 0.5);
    assert_eq!(island.balls[0].still_for(), 0.0, "it rolls");
    run(&mut island, &environment, 4.0);
    assert!(island.balls[0].still_for() > 1.0);
}

/// The greatest speed of a body is that of one of its particles. Lanes without a particle once fell for ever, and counted:
/// a cloth whose rows do not fill the lanes had ever growing bounds, and changed when it was saved and restored.
#[test]
fn the_greatest_speed_is_that_of_a_particle() {
    for (columns, rows) in [(13, 11), (40, 33), (16, 16), (5, 5)] {
        let cloth = ClothBuilder::new(1.0, 1.0, columns, rows).pin_edge(Edge::Top);
        let mut island = Island::of_body(cloth.build(BodySettings::default()).expect("valid"));
        run(&mut island, &gravity(FRAME), 2.0);
        let (found, expected) = (particles(&island).greatest_speed(), greatest_speed(&island));
        assert!(
            (found - expected).abs() <= 1e-5 * expected,
            "{columns} x {rows}: {found}, and {expected} m/s"
        );
    }
}
