//! S13: stiffness means the same for every time step, number of substeps and number of iterations.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, Island, StickKind, StickMaterial, StickProjection};

use crate::common::*;

fn soft(stiffness: f32) -> StickMaterial {
    StickMaterial { stiffness, damping: 0.0, ..StickMaterial::rigid(StickKind::Structural) }
}

/// The distance in metres by which a mass on a soft stick of 1 m hangs below its rest length.
fn sag(stiffness: f32, dt: f32, settings: BodySettings) -> f64 {
    let ends = [Vec3::ZERO, Vec3::NEG_Y];
    let body = joined_by(soft(stiffness), &ends, &[0.0, 1.0], &[[0, 1]], settings);
    let mut island = Island::of_body(body);
    run(&mut island, &gravity(dt), 12.0);
    assert!(greatest_speed(&island) < 1e-3, "it hangs still");
    f64::from(-particles(&island).position(1).y) - 1.0
}

/// S13: a mass on a soft stick sags by `g h0^2 (1 - s) / s` for every time step and any number of substeps and iterations.
#[test]
fn the_sag_of_a_mass_on_a_soft_stick_does_not_depend_on_the_solver() {
    for stiffness in [0.02, 0.1, 0.3] {
        let slack = f64::from((1.0 - stiffness) / stiffness);
        let expected = f64::from(G) * slack / 3600.0;
        for dt in [1.0 / 30.0, FRAME, 1.0 / 120.0, 1.0 / 240.0] {
            for (substeps, iterations) in [(1, 1), (4, 1), (1, 2), (1, 8), (2, 4)] {
                let settings = BodySettings { substeps, iterations, drag: 4.0, ..bare() };
                let found = sag(stiffness, dt, settings);
                let case =
                    format!("sag in m at stiffness {stiffness}, {dt:.4} s / {substeps} x {iterations}");
                law(&case, found, expected, 7e-3);
            }
        }
    }
}

/// S10, S13: the square-root-free form has the same softness at small strain.
#[test]
fn both_forms_of_the_stick_are_equally_soft_at_small_strain() {
    let settings = BodySettings { substeps: 4, drag: 4.0, ..bare() };
    let exact = sag(0.5, FRAME, settings);
    let free = sag(0.5, FRAME, BodySettings { projection: StickProjection::SquareRootFree, ..settings });
    assert_close("sag", free, exact, 0.02);
}

/// S13: a mass on a soft stick swings up and down with the period of its spring if the substep resolves it.
#[test]
fn a_soft_stick_swings_with_the_period_of_its_spring() {
    let stiffness = 0.01_f32;
    let slack = f64::from((1.0 - stiffness) / stiffness);
    let settings = BodySettings { substeps: 32, ..bare() };
    let ends = [Vec3::ZERO, Vec3::X];
    let mut body = joined_by(soft(stiffness), &ends, &[0.0, 1.0], &[[0, 1]], settings);
    body.particles.set_position(1, Vec3::X * 1.1);
    let mut island = Island::of_body(body);
    let mut crossing = None;
    let mut last = 0.1;
    run_with(&mut island, &weightless(FRAME), 2.0, |island, index| {
        let strain = particles(island).position(1).x - 1.0;
        if crossing.is_none() && strain <= 0.0 {
            crossing = Some((index as f32 + last / (last - strain)) * FRAME);
        }
        last = strain;
    });
    // x'' = -x / (h0^2 slack): from rest to the middle takes a quarter of the period.
    let expected = core::f64::consts::FRAC_PI_2 * slack.sqrt() / 60.0;
    law("quarter period of a soft stick in s", crossing.expect("it swings").into(), expected, 3.6e-3);
}

/// S13: a rigid stick does not sag, and one of stiffness 0 holds nothing.
#[test]
fn the_ends_of_the_scale_are_rigid_and_slack() {
    let settings = BodySettings { drag: 4.0, ..bare() };
    assert!(sag(1.0, FRAME, settings).abs() < 1e-5);
    let ends = [Vec3::ZERO, Vec3::NEG_Y];
    let mut island = Island::of_body(joined_by(soft(0.0), &ends, &[0.0, 1.0], &[[0, 1]], bare()));
    let mut free = Island::of_body(loose(&[Vec3::NEG_Y], bare()));
    run(&mut island, &gravity(FRAME), 1.0);
    run(&mut free, &gravity(FRAME), 1.0);
    assert!(particles(&island).position(1).distance(particles(&free).position(0)) < 1e-5);
}
