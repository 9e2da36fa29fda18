//! Halving dt changes gravity, drag, stiffness and friction by at most 2 %.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, Environment, Island, Obstacle, StickKind, StickMaterial};

use crate::common::*;

fn halved(what: &str, measure: impl Fn(f32) -> f64) {
    for dt in [FRAME, 1.0 / 120.0] {
        assert_close(what, measure(dt / 2.0), measure(dt), 0.02);
    }
}

/// S1: the distance fallen in a second.
#[test]
fn halving_dt_keeps_gravity() {
    halved("fall", |dt| {
        let mut island = Island::of_body(loose(&[Vec3::ZERO], bare()));
        run(&mut island, &gravity(dt), 1.0);
        -f64::from(particles(&island).position(0).y)
    });
}

/// S2: the speed after a second of falling and braking.
#[test]
fn halving_dt_keeps_drag() {
    halved("speed", |dt| {
        let mut body = loose(&[Vec3::ZERO], BodySettings { drag: 1.0, ..bare() });
        body.particles.set_velocity(0, Vec3::X * 10.0);
        let mut island = Island::of_body(body);
        run(&mut island, &gravity(dt), 1.0);
        f64::from(particles(&island).velocity(0).length())
    });
}

/// S13: the sag of a mass on a soft stick.
#[test]
fn halving_dt_keeps_stiffness() {
    halved("sag", |dt| {
        let material =
            StickMaterial { stiffness: 0.05, damping: 0.0, ..StickMaterial::rigid(StickKind::Structural) };
        let settings = BodySettings { drag: 4.0, iterations: 2, ..bare() };
        let body = joined_by(material, &[Vec3::ZERO, Vec3::NEG_Y], &[0.0, 1.0], &[[0, 1]], settings);
        let mut island = Island::of_body(body);
        run(&mut island, &gravity(dt), 10.0);
        -f64::from(particles(&island).position(1).y) - 1.0
    });
}

/// S7: the stopping distance under friction.
#[test]
fn halving_dt_keeps_friction() {
    halved("way", |dt| {
        let mut body = loose(&[Vec3::ZERO], BodySettings { friction: 0.5, ..bare() });
        body.particles.set_velocity(0, Vec3::X * 5.0);
        let mut island = Island::of_body(body);
        let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(dt) };
        run(&mut island, &environment, 2.0);
        f64::from(particles(&island).position(0).x)
    });
}

/// A change of dt from one step to the next keeps velocities.
#[test]
fn a_changing_step_keeps_speeds() {
    let mut body = loose(&[Vec3::ZERO], bare());
    body.particles.set_velocity(0, Vec3::new(3.0, 4.0, 0.0));
    let mut island = Island::of_body(body);
    let mut way = 0.0;
    for dt in [FRAME, 1.0 / 30.0, 1.0 / 144.0, 0.1, 1.0 / 1000.0] {
        run(&mut island, &weightless(dt), dt);
        way += 5.0 * dt;
        assert!((particles(&island).velocity(0) - Vec3::new(3.0, 4.0, 0.0)).length() < 1e-5);
    }
    assert!((particles(&island).position(0).length() - way).abs() < 1e-5);
}
