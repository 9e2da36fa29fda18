//! Cloth comes to rest in the same shape, with any time step and number of substeps.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, ClothBuilder, ClothMaterial, Island, RopeBuilder, StructuralSolve};

use crate::common::*;

/// Time steps in seconds, and substeps. The others are compared with the first.
const STEPS: [(f32, u32); 5] = [(FRAME, 16), (FRAME, 8), (FRAME, 32), (1.0 / 30.0, 16), (1.0 / 120.0, 16)];

/// For each of the [`STEPS`] but the first, the greatest distance of a particle from its place at rest with the first.
fn differences(
    body: impl Fn(BodySettings) -> Island,
    settings: BodySettings,
    seconds: f32,
) -> Vec<(String, f32)> {
    let at_rest = |(dt, substeps): (f32, u32)| {
        let mut island = body(BodySettings { substeps, ..settings });
        run(&mut island, &gravity(dt), seconds);
        assert!(greatest_speed(&island) < 0.02, "at rest: {} m/s", greatest_speed(&island));
        particles(&island).positions().collect::<Vec<Vec3>>()
    };
    let first = at_rest(STEPS[0]);
    let against = |step: (f32, u32)| {
        let apart = at_rest(step).iter().zip(&first).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
        (format!("{:.4} s / {}", step.0, step.1), apart)
    };
    STEPS[1..].iter().copied().map(against).collect()
}

/// A rope of 1 m that stands out level from two pins, and droops. Only its bend stiffness holds it.
#[test]
fn a_stiff_rope_droops_alike_in_every_step() {
    let rope = |settings| {
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X, 9).bend_stiffness(0.6).damping(1.0).pin(0).pin(1);
        Island::of_body(rope.build(settings).expect("valid"))
    };
    let settings = BodySettings { drag: 3.0, iterations: 8, ..bare() };
    for (step, apart) in differences(rope, settings, 8.0) {
        law_of_error(&format!("rest shape of a stiff rope in m, {step}"), apart.into(), 2.7e-3);
    }
}

/// A sheet of half a metre that hangs from two corners.
#[test]
fn a_sheet_on_two_corners_hangs_alike_in_every_step() {
    let sheet = |settings| {
        let sheet = ClothBuilder::new(0.5, 0.5, 9, 9)
            .material(ClothMaterial { damping: 1.0, ..ClothMaterial::default() });
        Island::of_body(sheet.pin(0).pin(8).build(settings).expect("valid"))
    };
    let sweeps = BodySettings { drag: 3.0, iterations: 2, tethers: true, ..bare() };
    for (structural, tolerance) in [(StructuralSolve::Sweeps, 7e-5), (StructuralSolve::Lines, 2e-5)] {
        for (step, apart) in differences(sheet, BodySettings { structural, ..sweeps }, 4.0) {
            law_of_error(
                &format!("rest shape of a sheet in m, {structural:?}, {step}"),
                apart.into(),
                tolerance,
            );
        }
    }
}
