//! S7: Coulomb friction of a sheet on a sheet, on an incline.

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{Body, BodySettings, ClothBuilder, Environment, Island, SelfContact};

use crate::common::*;

/// Half the distance that layers keep, in metres.
const THICKNESS: f32 = 0.01;

/// Coefficients of friction.
const COEFFICIENTS: [f32; 3] = [0.2, 0.5, 1.0];

/// The upper sheet's way downhill in `seconds`, and its speed at last, on a pinned sheet that is inclined by `angle`. Gravity leans in
/// place of the sheets, so that their places are as exact as those of level ones.
fn slid(angle: f32, friction: f32, speed: f32, seconds: f32) -> [f64; 2] {
    let settings = BodySettings {
        thickness: THICKNESS,
        friction,
        static_friction: friction,
        drag: 0.0,
        self_contact: SelfContact::On,
        ..BodySettings::default()
    };
    let lower = ClothBuilder::new(3.0, 0.6, 61, 13)
        .placed(Vec3::new(-0.5, 0.0, -0.3), Vec3::X, Vec3::Z)
        .pin_where(|_, _, _| true)
        .build(settings)
        .expect("valid");
    let mut upper = ClothBuilder::new(0.3, 0.3, 8, 8)
        .placed(Vec3::new(-0.15, 2.0 * THICKNESS, -0.15), Vec3::X, Vec3::Z)
        .build(settings)
        .expect("valid");
    (0..64).for_each(|i| upper.particles.set_velocity(i, Vec3::X * speed));
    let down = Vec3::new(angle.sin(), -angle.cos(), 0.0);
    let environment = Environment { gravity: G * down, ..gravity(FRAME) };
    let mut island = Island { bodies: vec![lower, upper], ..Island::default() };
    let middle = |body: &Body| centre_of_mass(&body.particles).x;
    let start = middle(&island.bodies[1]);
    run(&mut island, &environment, seconds);
    let upper = &island.bodies[1];
    let mass = measure::mass(&upper.particles);
    [middle(upper) - start, measure::momentum(&upper.particles).x / mass]
}

/// S7: a fifth of a degree below the angle of friction, a layer does not move by a tenth of a millimetre in a second.
#[test]
fn below_the_angle_of_friction_a_layer_sticks_to_the_one_below() {
    for friction in COEFFICIENTS {
        for below in [0.2_f32, 2.0] {
            let [way, _] = slid(friction.atan() - below.to_radians(), friction, 0.0, 1.0);
            law_of_error(&format!("creep in m, friction {friction}, {below} degrees below"), way, 1e-4);
        }
    }
}

/// S7: above that angle it slides, and accelerates by `g (sin - mu cos)`.
#[test]
fn above_the_angle_of_friction_a_layer_slides_by_what_friction_leaves_of_gravity() {
    let cases = COEFFICIENTS.map(|friction| (friction.atan() + 2.0_f32.to_radians(), friction, 0.05));
    let steep = [0.0, 0.2, 0.5].map(|friction| (40.0_f32.to_radians(), friction, 2e-3));
    for (angle, friction, tolerance) in cases.into_iter().chain(steep) {
        let seconds = 0.6;
        let [_, speed] = slid(angle, friction, 0.0, seconds);
        let expected = G * (angle.sin() - friction * angle.cos());
        let case = format!(
            "acceleration of a layer on a layer, {:.1} degrees, friction {friction}",
            angle.to_degrees()
        );
        law(&case, speed / f64::from(seconds), expected.into(), tolerance);
    }
    for friction in COEFFICIENTS {
        let [way, _] = slid(friction.atan() + 0.2_f32.to_radians(), friction, 0.0, 1.0);
        assert!(way > 0.015, "{way} m at a friction of {friction}, a fifth of a degree above");
    }
}

/// S7: on the level, friction stops a slide after `v^2 / (2 mu g)`, and does not reverse it.
#[test]
fn a_layer_that_slides_on_another_stops_after_the_distance_of_coulomb() {
    for (speed, friction) in [(2.0, 0.3), (1.0, 0.5)] {
        let [way, last] = slid(0.0, friction, speed, 1.0);
        let expected = speed * speed / (2.0 * friction * G);
        law(
            &format!("way of a layer to a stop from {speed} m/s, friction {friction}"),
            way,
            expected.into(),
            0.01,
        );
        law_of_error("speed at last in m/s", last, 1e-4);
    }
}
