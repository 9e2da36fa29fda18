//! Ropes hang as a catenary.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, Island, RopeBuilder, StructuralSolve, step};

use crate::common::*;

/// Parameter `a` of the catenary `y = a cosh(x / a)` of `length` between two points `span` apart at one height.
fn catenary(length: f64, span: f64) -> f64 {
    let (mut low, mut high) = (span / 200.0, span * 1e4);
    for _ in 0..200 {
        let a = 0.5 * (low + high);
        // A flatter curve (larger a) is shorter.
        if 2.0 * a * (span / (2.0 * a)).sinh() > length { low = a } else { high = a }
    }
    0.5 * (low + high)
}

/// A rope of 3 m at rest, whose ends were brought to `span` metres apart.
fn hung(span: f32, settings: BodySettings, links: u32) -> Island {
    let length = 3.0;
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * length, links + 1)
        .pin_start()
        .pin_end()
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(rope);
    let environment = gravity(FRAME);
    for index in 1..=120 {
        let end = length + (span - length) * index as f32 / 120.0;
        island.bodies[0].particles.set_pin_target(links as usize, Vec3::X * end);
        step(&mut island, &environment).expect("a good step");
    }
    run(&mut island, &environment, 12.0);
    assert!(greatest_speed(&island) < 0.02, "at rest: {} m/s", greatest_speed(&island));
    island
}

/// A pinned rope hangs as the catenary `y = a cosh(x / a)`, `2 a sinh(d / 2a) = L` for a rope of length L between points d
/// apart (Johann Bernoulli, Huygens and Leibniz 1691). Compares its sag, and its height all along. (31 links are too few for
/// lines: they are swept.)
#[test]
fn a_pinned_rope_hangs_as_a_catenary() {
    let sweeps = BodySettings { substeps: 16, iterations: 4, drag: 3.0, ..bare() };
    let ways = [
        ("sweeps", sweeps, [5.1e-3, 0.044]),
        ("tethers", BodySettings { tethers: true, ..sweeps }, [0.011, 0.054]),
        (
            "lines",
            BodySettings { structural: StructuralSolve::Lines, iterations: 1, ..sweeps },
            [0.016, 4.4e-4],
        ),
    ];
    for (way, settings, tolerances) in ways {
        for (links, tolerance) in [31, 101].into_iter().zip(tolerances) {
            for span in [2.7_f32, 2.0, 1.0] {
                let island = hung(span, settings, links);
                let span = f64::from(span);
                let a = catenary(3.0, span);
                let sag = a * ((span / (2.0 * a)).cosh() - 1.0);
                let lowest = particles(&island).positions().map(|p| -p.y).fold(0.0, f32::max);
                let case = format!("{way}, {links} links, {span:.1} m apart");
                law(&format!("catenary's sag, {case}"), lowest.into(), sag, tolerance);
                let errors = particles(&island).positions().map(|p| {
                    let y = a * (((f64::from(p.x) - span / 2.0) / a).cosh() - (span / (2.0 * a)).cosh());
                    (f64::from(p.y) - y).abs() / sag
                });
                let shape = errors.fold(0.0, f64::max);
                law_of_error(&format!("catenary's shape in sags, {case}"), shape, tolerance);
            }
        }
    }
}

/// A rope pinned at one end hangs straight down, at its rest length.
#[test]
fn a_rope_on_one_pin_hangs_straight_at_its_length() {
    let settings = BodySettings { substeps: 16, iterations: 2, drag: 2.0, ..BodySettings::default() };
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 2.0, 21).pin_start().build(settings).expect("valid");
    let mut island = Island::of_body(rope);
    run(&mut island, &gravity(FRAME), 15.0);
    let end = particles(&island).position(20);
    assert!((end - Vec3::NEG_Y * 2.0).length() < 0.02, "{end}");
}
