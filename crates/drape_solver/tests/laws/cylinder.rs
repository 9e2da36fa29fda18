//! A rope over a cylinder: without friction it is Atwood's machine, with friction a capstan.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{BodySettings, Environment, Island, Obstacle, Placement, Shape};

use crate::common::*;

/// Length of the rope on either side of the cylinder at the start, in metres.
const SIDE: f32 = 0.6;
const RADIUS: f32 = 0.2;
const THICKNESS: f32 = 0.005;
const LINKS: u32 = 60;
/// Mass of the whole rope in kilograms.
const ROPE: f32 = 0.3;

/// The side of a capsule: a cylinder whose nearest point is computed in every substep.
const SMOOTH: Shape = Shape::Capsule { half_length: 1.0, radius: RADIUS };

/// A rope half around a `cylinder` of this `friction`, with these masses (kg) at its two ends.
fn over_cylinder(
    cylinder: Shape,
    masses: [f32; 2],
    rope: f32,
    friction: f32,
    settings: BodySettings,
) -> (Island, Environment) {
    let r = RADIUS + THICKNESS;
    let arc = core::f32::consts::PI * r;
    let length = arc + 2.0 * SIDE;
    let place = |i: u32| {
        let along = length * i as f32 / LINKS as f32 - SIDE;
        let angle = core::f32::consts::PI - (along / r).clamp(0.0, core::f32::consts::PI);
        let down = (-along).max(along - arc).max(0.0);
        Vec3::new(r * angle.cos(), r * angle.sin() - down, 0.0)
    };
    let positions: Vec<Vec3> = (0..=LINKS).map(place).collect();
    let link = rope / LINKS as f32;
    let mut inverse_masses = vec![1.0 / link; positions.len()];
    inverse_masses[0] = 1.0 / (masses[0] + 0.5 * link);
    inverse_masses[LINKS as usize] = 1.0 / (masses[1] + 0.5 * link);
    let sticks: Vec<[u32; 2]> = (0..LINKS).map(|i| [i, i + 1]).collect();
    let settings = BodySettings { friction, thickness: THICKNESS, ..settings };
    let island = Island::of_body(joined(&positions, &inverse_masses, &sticks, settings));
    let rotation = Quat::from_rotation_x(core::f32::consts::FRAC_PI_2);
    let cylinder =
        Obstacle::new(cylinder, Placement { rotation, ..Placement::default() }, friction).expect("valid");
    (island, Environment { obstacles: vec![cylinder].into(), ..gravity(FRAME) })
}

/// With masses m1 < m2 and a rope of r kg for each metre, M kg in all, the heavier end goes down by
/// `x = (m2 - m1) / 2r (cosh(k t) - 1)`, `k^2 = 2 r g / M` (Atwood 1784; the rope that has gone over adds to the pull).
///
/// For each particle, parry's cylinder is a plane during a whole step: the rope runs over edges, which brake it.
///
/// More iterations are not better here: a link weighs a hundredth of an end. With 16 x 64 sweeps it moves the end by less
/// than single precision resolves, which holds the rope back by a fifth.
#[test]
fn a_rope_over_a_smooth_cylinder_runs_as_atwoods_machine() {
    for (light, heavy, seconds) in [(0.5, 0.6, 0.7_f32), (0.5, 1.0, 0.4)] {
        let of_parry = Shape::from_parry(SharedShape::cylinder(1.0, RADIUS)).expect("valid");
        let ways = [(SMOOTH, 4, 0.027), (SMOOTH, 8, 6e-3), (SMOOTH, 16, 9e-3), (of_parry, 16, 0.21)];
        for (shape, substeps, tolerance) in ways {
            let settings = BodySettings { substeps, iterations: 16, ..bare() };
            let (mut island, environment) = over_cylinder(shape.clone(), [light, heavy], ROPE, 0.0, settings);
            let ends = |island: &Island| [0, LINKS as usize].map(|i| particles(island).position(i).y);
            let before = ends(&island);
            run(&mut island, &environment, seconds);
            let after = ends(&island);
            // Takes the mean of both ends, as the rope stretches a little.
            let found = 0.5 * f64::from(after[0] - before[0] + before[1] - after[1]);
            let length = core::f32::consts::PI * (RADIUS + THICKNESS) + 2.0 * SIDE;
            let linear = f64::from(ROPE / length);
            let k = (2.0 * linear * f64::from(G) / f64::from(light + heavy + ROPE)).sqrt();
            let expected =
                f64::from(heavy - light) / (2.0 * linear) * ((k * f64::from(seconds)).cosh() - 1.0);
            let kind = if matches!(shape, Shape::Parry(_)) { "parry's cylinder" } else { "capsule" };
            let case = format!("{light} and {heavy} kg, {kind}, {substeps} substeps");
            law(&format!("Atwood's way in m, {case}"), found, expected, tolerance);
        }
    }
}

/// S7: the capstan equation (Euler 1769). The heavier end slides down if it weighs more than `exp(mu phi)` times the other;
/// phi is the angle of the rope around the cylinder.
#[test]
fn a_rope_over_a_rough_cylinder_slides_where_eulers_formula_has_it() {
    let friction = 0.3_f32;
    let slid = |ratio: f32| {
        let settings = BodySettings { substeps: 16, iterations: 100, ..bare() };
        // The rope itself has almost no mass.
        let (mut island, environment) = over_cylinder(SMOOTH, [1.0, ratio], 0.12, friction, settings);
        run(&mut island, &environment, 1.0);
        -SIDE - particles(&island).position(LINKS as usize).y
    };
    let critical = (friction * core::f32::consts::PI).exp();
    // The rope stretches by less than this when the weights begin to pull.
    let slides = |ratio: f32| slid(ratio) > 0.05;
    let (mut holds, mut gives) = (0.9 * critical, 1.1 * critical);
    assert!(!slides(holds) && slides(gives), "it holds at nine tenths and slides at eleven tenths");
    for _ in 0..5 {
        let middle = 0.5 * (holds + gives);
        if slides(middle) { gives = middle } else { holds = middle }
    }
    law("capstan, ratio of the weights", f64::from(0.5 * (holds + gives)), critical.into(), 0.0145);
}
