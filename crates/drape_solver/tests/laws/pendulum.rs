//! A mass on a stick is the mathematical pendulum, except for a damping of first order in the substep.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, Island};

use crate::common::*;

/// Length of the stick in metres.
const LENGTH: f32 = 1.0;

/// Complete elliptic integral of the first kind, of modulus `k`, by the arithmetic-geometric mean (Abramowitz and Stegun
/// 17.6.3).
fn complete_elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    core::f64::consts::FRAC_PI_2 / a
}

/// The first swing of a pendulum released at `angle` (radians): its period in seconds, and the part of the amplitude (as an
/// angle) that is left at its second turning point.
fn first_swing(angle: f64, substeps: u32) -> (f64, f64) {
    let bob = Vec3::new(angle.sin() as f32, -angle.cos() as f32, 0.0) * LENGTH;
    let settings = BodySettings { substeps, ..bare() };
    let body = joined(&[Vec3::ZERO, bob], &[0.0, 1.0], &[[0, 1]], settings);
    let mut island = Island::of_body(body);
    let (mut crossings, mut last, mut highest) = (Vec::new(), angle, 0.0_f64);
    // Short steps, so that linear interpolation between two of them is accurate enough.
    let dt = FRAME / 4.0;
    run_with(&mut island, &gravity(dt), 3.0, |island, index| {
        let place = particles(island).position(1).as_dvec3();
        let now = place.x.atan2(-place.y);
        if last * now < 0.0 {
            crossings.push((index as f64 + last / (last - now)) * f64::from(dt));
        }
        if crossings.len() == 2 {
            highest = highest.max(now);
        }
        last = now;
    });
    (crossings[2] - crossings[0], highest / angle)
}

/// The period is `4 sqrt(L/g) K(sin(a/2))`, K the complete elliptic integral (Landau and Lifshitz, Mechanics, section 11).
///
/// In substeps of 1/15,000 s (64 here, or 256 in 1/60 s) gravity adds less to a displacement than single precision resolves:
/// the period is then 17 % off at 5 degrees.
#[test]
fn the_period_of_the_first_swing_is_the_elliptic_integral() {
    for (degrees, tolerances) in [(5.0_f64, [4e-3, 2.1e-3, 0.26]), (60.0, [0.0112, 2.2e-3, 0.07])] {
        let angle = degrees.to_radians();
        let expected = 4.0 * f64::from(LENGTH / G).sqrt() * complete_elliptic((0.5 * angle).sin());
        for (substeps, tolerance) in [1, 8, 64].into_iter().zip(tolerances) {
            let (period, _) = first_swing(angle, substeps);
            law(
                &format!("pendulum's period at {degrees} degrees, {substeps} substeps of 1/240 s"),
                period,
                expected,
                tolerance,
            );
        }
    }
}

/// Projection onto the stick takes `g cos(a) h / L` of the bob's speed each second, so that small swings decay as
/// `exp(-g h t / 2L)`, to first order in the substep `h`. (The bob flies `g h^2` beyond the end of the stick; projection
/// back shortens its path along the circle.)
#[test]
fn the_numerical_damping_of_a_pendulum_is_of_first_order() {
    let angle = 5.0_f64.to_radians();
    let mut before = None;
    for substeps in [1, 2, 4] {
        let h = f64::from(FRAME) / 4.0 / f64::from(substeps);
        let rate = f64::from(G / LENGTH) * h / 2.0;
        let period = core::f64::consts::TAU * f64::from(LENGTH / G).sqrt();
        let (_, left) = first_swing(angle, substeps);
        let decay = -left.ln() / period;
        law(&format!("pendulum's damping in 1/s at a substep of {h:.2e} s"), decay, rate, 9e-3);
        if let Some(before) = before {
            law("pendulum's damping as the substep is halved", decay / before, 0.5, 2e-3);
        }
        before = Some(decay);
    }
}
