//! Motion limits: the greatest distance of a particle from its animated place.

use drape_solver::glam::Vec3;
use drape_solver::{Body, BodySettings, Environment, Island, Obstacle, Shape, step};

use crate::common::*;

/// A sheet of a metre that hangs from its top edge, with limits from 0 at the top to `lowest` metres at the bottom.
fn sheet(particles: u32, lowest: f32) -> Body {
    let mut body = hanging_sheet(particles);
    for i in 0..body.particles.len() {
        let place = body.particles.position(i);
        body.particles.set_motion_limit(i, place, (2.0 - place.y) * lowest);
    }
    body
}

/// Displacement in metres of the rail and of all limits' centres after this time in seconds.
fn way(time: f32) -> Vec3 {
    Vec3::new(1.5 * libm::sinf(3.0 * time), 0.2 * libm::sinf(7.0 * time), 0.4 * libm::sinf(5.0 * time))
}

fn swing(body: &mut Body, rest: &[Vec3], time: f32) {
    for (i, place) in rest.iter().enumerate() {
        let place = *place + way(time);
        body.particles.set_pin_target(i, place);
        body.particles.set_limit_centre(i, place);
    }
}

/// The greatest distance in metres of a particle beyond its limit.
fn excess(body: &Body) -> f32 {
    let limits = (0..body.particles.len()).filter_map(|i| {
        let (centre, distance) = body.particles.motion_limit(i)?;
        Some(body.particles.position(i).distance(centre) - distance)
    });
    limits.fold(f32::NEG_INFINITY, f32::max)
}

/// Limits hold at the end of every step, while the cloth swings and falls, and a sphere pushes it.
#[test]
fn limits_hold_through_all_that_pulls_and_pushes() {
    let mut worst = f32::NEG_INFINITY;
    let mut touched = 0;
    for lowest in [0.0, 0.02, 0.2, 1.0] {
        let mut island = Island::of_body(sheet(unless_miri(24, 5), lowest));
        let rest = positions(&island.bodies[0]);
        let pole = obstacle(Shape::Capsule { half_length: 1.0, radius: 0.1 }, Vec3::new(0.3, 1.5, 0.15), 0.5);
        let environment = Environment { obstacles: vec![pole].into(), ..gravity(FRAME) };
        for index in 1..=unless_miri(240, 3) {
            swing(&mut island.bodies[0], &rest, index as f32 * FRAME);
            step(&mut island, &environment).expect("a good step");
            worst = worst.max(excess(&island.bodies[0]));
            touched += island.body_contacts(0).count();
        }
    }
    println!("law: limits on motion are exceeded by at most {worst:.2e} m");
    assert!(worst < 1e-5, "{worst} m");
    assert!(touched > 0 || cfg!(miri), "nothing was in the way");
}

/// Under a limit of zero the particles follow the animation exactly.
#[test]
fn a_limit_of_zero_follows_the_animation() {
    let mut island = Island::of_body(sheet(8, 0.0));
    let rest = positions(&island.bodies[0]);
    for index in 1..=unless_miri(60, 2) {
        swing(&mut island.bodies[0], &rest, index as f32 * FRAME);
        step(&mut island, &gravity(FRAME)).expect("a good step");
        for (place, expected) in positions(&island.bodies[0]).into_iter().zip(&rest) {
            assert!(place.distance(*expected + way(index as f32 * FRAME)) < 1e-5);
        }
    }
}

/// A limit does not affect a particle inside it.
#[test]
fn a_limit_out_of_reach_changes_no_bit() {
    let mut islands = [sheet(16, 1.0), sheet(16, 1.0)].map(Island::of_body);
    islands[1].bodies[0].particles.clear_motion_limits();
    let far = islands[0].bodies[0].particles.len();
    (0..far).for_each(|i| islands[0].bodies[0].particles.set_motion_limit(i, Vec3::ZERO, 50.0));
    for _ in 0..unless_miri(60, 2) {
        islands.iter_mut().for_each(|island| step(island, &gravity(FRAME)).expect("a good step"));
    }
    assert_eq!(hash(&islands[0]), hash(&islands[1]));
}

/// A particle at its limit has no velocity outwards.
#[test]
fn what_is_held_back_does_not_swing_on() {
    let mut body = loose(&[Vec3::ZERO], bare());
    body.particles.set_motion_limit(0, Vec3::ZERO, 0.5);
    body.particles.set_velocity(0, Vec3::X * 3.0);
    let mut island = Island::of_body(body);
    for _ in 0..30 {
        step(&mut island, &weightless(FRAME)).expect("a good step");
    }
    let particles = &island.bodies[0].particles;
    assert!((particles.position(0) - Vec3::X * 0.5).length() < 1e-5, "{}", particles.position(0));
    assert!(particles.velocity(0).length() < 1e-3, "{}", particles.velocity(0));
}

/// If a limit and an obstacle contradict each other the limit holds, and the conflict is counted; otherwise both hold.
#[test]
fn a_limit_wins_over_an_obstacle_and_is_counted() {
    for (distance, is_conflict) in [(0.02, true), (0.5, false)] {
        let settings = BodySettings { thickness: 0.01, ..bare() };
        let mut body = loose(&[Vec3::new(0.0, 0.05, 0.0), Vec3::new(2.0, 0.0, 0.0)], settings);
        body.particles.set_motion_limit(0, Vec3::new(0.0, 0.05, 0.0), distance);
        body.particles.set_motion_limit(1, Vec3::new(2.0, 0.0, 0.0), distance);
        let mut island = Island::of_body(body);
        let ball = obstacle(Shape::Sphere { radius: 0.2 }, Vec3::ZERO, 0.0);
        let environment = Environment { obstacles: vec![ball].into(), ..weightless(FRAME) };
        for _ in 0..120 {
            step(&mut island, &environment).expect("a good step");
        }
        let body = &island.bodies[0];
        assert!(excess(body) < 1e-6);
        let outside = body.particles.position(0).length() - 0.21;
        assert_eq!(outside < -1e-3, is_conflict, "{outside} m outside");
        assert_eq!(body.context.limit_conflicts(), usize::from(is_conflict));
    }
}

/// A whole step and its stages one by one give the same bits, on every instruction set.
#[test]
fn bits_depend_neither_on_instructions_nor_on_the_way_stages_are_run() {
    assert_same_on_all(|isa, take_step| {
        let mut island = Island { isa, ..Island::of_body(sheet(unless_miri(64, 6), 0.3)) };
        let rest = positions(&island.bodies[0]);
        let floor = vec![Obstacle::ground(), obstacle(Shape::Sphere { radius: 0.2 }, Vec3::Y * 1.5, 0.5)];
        let environment = Environment { obstacles: floor.into(), ..gravity(FRAME) };
        for index in 1..=unless_miri(40, 2) {
            swing(&mut island.bodies[0], &rest, index as f32 * FRAME);
            take_step(&mut island, &environment);
        }
        (hash(&island), island.bodies[0].context.limit_conflicts())
    });
}

/// A body continues identically after its state was saved and restored.
#[test]
fn a_restored_body_goes_on_with_the_same_bits() {
    assert_goes_on_when_restored([sheet(12, 0.2), sheet(12, 0.7)], swing);
}

/// Limits stay with their particles when the cloth is cut.
#[test]
fn pieces_keep_their_limits() {
    let mut body = sheet(12, 0.1);
    let blade = [Vec3::new(0.05, 3.0, -1.0), Vec3::new(0.05, 3.0, 1.0), Vec3::new(0.05, -3.0, 0.0)];
    let limits: Vec<_> = (0..body.particles.len()).map(|i| body.particles.motion_limit(i)).collect();
    let torn = body.cut(&[blade]).expect("valid").expect("in two");
    let pieces = torn.pieces.iter().map(|piece| (&piece.body, &piece.origins));
    for (piece, origins) in pieces.chain([(&body, &torn.origins)]) {
        for (i, &origin) in origins.iter().enumerate() {
            assert_eq!(piece.particles.motion_limit(i), limits[origin as usize]);
        }
    }
}
