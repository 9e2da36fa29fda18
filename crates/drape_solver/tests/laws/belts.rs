//! S7: friction with a moving surface carries bodies along.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{BallMaterial, BodySettings, Environment, Island, Obstacle, Placement, Shape};

use crate::common::*;

/// A slab with its top at height 0, friction 0.5.
fn slab() -> Obstacle {
    obstacle(Shape::Cuboid { half_extents: Vec3::new(20.0, 0.5, 20.0) }, Vec3::Y * -0.5, 0.5)
}

/// Steps through `seconds`. `place` gives the slab's placement at the end of each step.
fn run_on_slab(island: &mut Island, seconds: f32, place: impl Fn(f32) -> Placement) {
    let mut environment = Environment { obstacles: vec![slab()].into(), ..gravity(FRAME) };
    let steps = (seconds / FRAME).round() as usize;
    for index in 1..=steps {
        environment.obstacles[0].move_to(place(index as f32 * FRAME), FRAME);
        drape_solver::step(island, &environment).expect("a good step");
    }
}

/// S7: a belt takes a particle from rest to its own speed with the acceleration `mu g`.
#[test]
fn a_belt_brings_particles_to_its_speed() {
    for substeps in [1, 8] {
        let speed = 2.0;
        let belt = |t: f32| Placement::at(Vec3::new(speed * t, -0.5, 0.0));
        let settings = BodySettings { substeps, iterations: 2, friction: 0.5, ..bare() };
        let mut island = Island::of_body(loose(&[Vec3::ZERO], settings));
        run_on_slab(&mut island, 0.2, belt);
        let halfway = particles(&island).velocity(0).x;
        assert_close("speed after 0.2 s", halfway.into(), f64::from(0.5 * G * 0.2), 0.05);
        run_on_slab(&mut island, 0.8, |t| belt(t + 0.2));
        let end = particles(&island).velocity(0);
        assert!((end - Vec3::X * speed).length() < 1e-2, "{end}");
    }
}

/// S7: a belt carries a sheet along without stretching it.
#[test]
fn a_belt_carries_a_sheet() {
    let sheet = drape_solver::ClothBuilder::new(1.0, 1.0, 9, 9)
        .placed(Vec3::Y * 0.005, Vec3::X, Vec3::Z)
        .build(BodySettings::default())
        .expect("valid");
    let mut island = Island::of_body(sheet);
    run_on_slab(&mut island, 2.0, |t| Placement::at(Vec3::new(1.5 * t, -0.5, 0.0)));
    for velocity in particles(&island).velocities() {
        assert!((velocity - Vec3::X * 1.5).length() < 0.1, "{velocity}");
    }
    assert!(stretch(&island).rms < 1e-3);
}

/// S7: on a turning disc a particle goes round with it.
#[test]
fn a_turntable_carries_particles_round() {
    let settings = BodySettings { substeps: 8, iterations: 2, friction: 0.5, ..bare() };
    let mut island = Island::of_body(loose(&[Vec3::X], settings));
    let turns = 1.0;
    let mut angle = 0.0;
    let mut environment = Environment { obstacles: vec![slab()].into(), ..gravity(FRAME) };
    for index in 1..=180 {
        // The disc spins up over a second, then keeps its rate: mu g holds the particle at this radius.
        let t = index as f32 * FRAME;
        let rate = turns * t.min(1.0);
        angle += rate * FRAME;
        let rotation = Quat::from_rotation_y(angle);
        let place = Placement { translation: Vec3::Y * -0.5, rotation };
        environment.obstacles[0].move_to(place, FRAME);
        drape_solver::step(&mut island, &environment).expect("a good step");
    }
    let position = particles(&island).position(0);
    let expected = Quat::from_rotation_y(angle) * Vec3::X;
    assert!((position - expected).length() < 0.03, "{position} and not {expected}");
    assert_close("speed", particles(&island).velocity(0).length().into(), f64::from(turns), 0.02);
}

/// A ball on a belt starts to roll backwards relative to it, and ends rolling without slip at 2/7 of the belt's speed.
#[test]
fn a_belt_sets_a_ball_rolling() {
    let material = BallMaterial { friction: 0.5, ..smooth(0.2, 1.0) };
    let mut island = Island::of_ball(ball(material, Vec3::Y * 0.2, Vec3::ZERO));
    run_on_slab(&mut island, 2.0, |t| Placement::at(Vec3::new(2.1 * t, -0.5, 0.0)));
    let (velocity, spin) = (island.balls[0].velocity(), island.balls[0].spin());
    assert_close("speed", velocity.x.into(), 2.1 * 2.0 / 7.0, 0.01);
    let surface = velocity + spin.cross(Vec3::Y * -0.2);
    assert!((surface - Vec3::X * 2.1).length() < 0.02, "its surface goes with the belt: {surface}");
}
