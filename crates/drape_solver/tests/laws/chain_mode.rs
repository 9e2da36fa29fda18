//! The lowest mode of a hanging chain.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, Island, RopeBuilder, StructuralSolve};

use crate::common::*;

/// First zero of the Bessel function J0.
const ZERO_OF_BESSEL: f64 = 2.404_825_557_695_773;

/// The Bessel function J0, by its power series (Abramowitz and Stegun 9.1.12).
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..20 {
        term *= -0.25 * x * x / f64::from(k * k);
        sum += term;
    }
    sum
}

/// The time in seconds between two passages of the free end through the plumb line in the same direction.
fn period(structural: StructuralSolve, substeps: u32, links: u32, length: f32) -> f64 {
    let settings = BodySettings { substeps, iterations: 2, structural, ..bare() };
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::NEG_Y * length, links + 1).pin_start();
    let mut island = Island::of_body(rope.build(settings).expect("valid"));
    let body = &mut island.bodies[0].particles;
    for i in 1..=links as usize {
        let from_end = 1.0 - i as f64 / f64::from(links);
        let aside = 0.01 * f64::from(length) * bessel(ZERO_OF_BESSEL * from_end.sqrt());
        body.set_position(i, body.position(i) + Vec3::X * aside as f32);
    }
    let (mut crossings, mut last) = (Vec::new(), 1.0);
    run_with(&mut island, &gravity(FRAME), 5.0 * length.sqrt(), |island, index| {
        let now = particles(island).position(links as usize).x;
        if last * now < 0.0 {
            crossings.push(f64::from((index as f32 + last / (last - now)) * FRAME));
        }
        last = now;
    });
    crossings[2] - crossings[0]
}

/// The lowest mode has the shape `J0(2.4048 sqrt(s / L))`, with s from the free end, and the period
/// `T = (4 pi / 2.4048) sqrt(L / g)` (Daniel Bernoulli 1732; Lamb, Higher Mechanics).
#[test]
fn a_hanging_chain_swings_with_bernoullis_period() {
    for (length, links) in [(1.0_f32, 50), (2.0, 100)] {
        let expected = 4.0 * core::f64::consts::PI / ZERO_OF_BESSEL * f64::from(length / G).sqrt();
        for (structural, tolerances) in
            [(StructuralSolve::Sweeps, [0.038, 6e-4]), (StructuralSolve::Lines, [1.5e-4, 8e-4])]
        {
            for (substeps, tolerance) in [16, 64].into_iter().zip(tolerances) {
                let found = period(structural, substeps, links, length);
                let case = format!("{structural:?}, {links} links, {substeps} substeps");
                law(&format!("chain's lowest mode, {case}"), found, expected, tolerance);
            }
        }
    }
}
