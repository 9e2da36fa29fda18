//! S2: drag, in 1/s and independent of the step.

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{BallMaterial, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Wind};

use crate::common::*;

const STEPS: [(f32, u32); 5] = [(1.0 / 30.0, 1), (FRAME, 1), (FRAME, 4), (FRAME, 16), (1.0 / 240.0, 2)];

/// S2: without forces speed decays as `exp(-drag t)`, in every step and number of substeps.
#[test]
fn speed_decays_as_the_exponential_of_drag_and_time() {
    for (dt, substeps) in STEPS {
        let settings = BodySettings { drag: 1.5, substeps, ..bare() };
        let mut body = loose(&[Vec3::ZERO], settings);
        body.particles.set_velocity(0, Vec3::new(6.0, 0.0, 8.0));
        let mut island = Island::of_body(body);
        run(&mut island, &weightless(dt), 1.0);
        let speed = particles(&island).velocity(0).length();
        law(&format!("decay by drag, {dt:.4} s / {substeps}"), speed.into(), 10.0 * f64::exp(-1.5), 9e-6);
    }
}

/// S2: the factor of 0.99 per step of the founding papers is a drag of `-60 ln 0.99` at 60 Hz.
#[test]
fn the_textbook_factor_is_a_drag_per_second() {
    let drag = (-60.0 * f64::ln(0.99)) as f32;
    let mut body = loose(&[Vec3::ZERO], BodySettings { drag, ..bare() });
    body.particles.set_velocity(0, Vec3::X);
    let mut island = Island::of_body(body);
    run(&mut island, &weightless(FRAME), FRAME);
    assert_close("speed", particles(&island).velocity(0).x.into(), 0.99, 1e-6);
}

/// S2, S18: balls have a drag of their own, which is 0 by default.
#[test]
fn a_ball_has_its_own_drag() {
    for (drag, left) in [(0.0, 1.0), (1.5, f64::exp(-1.5))] {
        let material = BallMaterial { drag, ..smooth(0.1, 1.0) };
        let mut island = Island::of_ball(ball(material, Vec3::ZERO, Vec3::X * 10.0));
        run(&mut island, &weightless(FRAME), 1.0);
        assert_close("speed", island.balls[0].velocity().x.into(), 10.0 * left, 1e-4);
    }
    assert_eq!(BallMaterial::default().drag, 0.0);
}

/// Drag brakes against still air. A wind carries a sheet along, and never makes it faster than the wind: not in one long
/// step, and not a light sheet in a storm.
#[test]
fn a_sheet_is_carried_to_the_speed_of_the_wind_and_not_past_it() {
    for (areal_density, speed) in [(0.25, 8.0), (0.05, 40.0), (0.01, 100.0)] {
        for substeps in [1, 8] {
            let material = ClothMaterial { areal_density, ..ClothMaterial::default() };
            let sheet = ClothBuilder::new(1.0, 1.0, 9, 9).material(material);
            let settings = BodySettings { substeps, ..bare() };
            let mut island = Island::of_body(sheet.build(settings).expect("valid"));
            let environment = Environment { wind: Wind::new(Vec3::Z * speed), ..weightless(FRAME) };
            run_with(&mut island, &environment, 5.0, |island, _| {
                let fastest = greatest_speed(island);
                assert!(fastest < speed * 1.25, "{fastest} m/s in a wind of {speed} m/s");
            });
            let carried = momentum(&island).z / measure::mass(particles(&island));
            let expected = f64::from(speed);
            assert!((0.85 * expected..1.01 * expected).contains(&carried), "{carried} m/s in {speed} m/s");
        }
    }
}
