//! Momentum and energy across hits without gravity: contacts, friction and sticks keep momentum and gain no energy.

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{BallMaterial, BodySettings, ClothBuilder, ClothMaterial, Island};

use crate::common::*;

/// A spinning ball about to hit a free sheet off its middle, at an angle.
fn hit(substeps: u32) -> Island {
    let settings = BodySettings { substeps, iterations: 2, drag: 0.0, ..BodySettings::default() };
    let sheet = ClothBuilder::new(1.5, 1.2, 21, 17)
        .placed(Vec3::new(-0.75, 0.6, 0.0), Vec3::X, Vec3::NEG_Y)
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(sheet);
    let mut ball = ball(BallMaterial::default(), Vec3::new(0.2, 0.1, 0.4), Vec3::new(0.5, -0.3, -10.0));
    ball.set_spin(Vec3::new(1.0, 2.0, 3.0));
    island.balls.push(ball);
    island
}

/// Ball and free cloth keep their linear momentum, to single precision.
#[test]
fn a_ball_and_a_free_cloth_keep_their_momentum() {
    for substeps in [4, 16, 64] {
        let mut island = hit(substeps);
        let before = momentum(&island);
        run_with(&mut island, &weightless(FRAME), 1.0, |island, index| {
            let error = (momentum(island) - before).length() / before.length();
            assert!(error < 1e-5, "{error} of the momentum is lost at step {index}");
        });
        let ball = island.balls[0].velocity().length();
        assert!(ball < 9.6, "the hit must have happened: {ball} m/s");
    }
}

/// A ball of M kg and v m/s takes a cloth of m kg along: their common centre moves on at `M v / (M + m)`.
#[test]
fn the_common_centre_of_ball_and_cloth_goes_on_at_its_speed() {
    for substeps in [4, 16] {
        let mut island = hit(substeps);
        let (cloth, iron) = (measure::mass(particles(&island)), f64::from(island.balls[0].material().mass));
        let centre = |island: &Island| {
            let ball = island.balls[0].position().as_dvec3();
            (centre_of_mass(particles(island)) * cloth + ball * iron) / (cloth + iron)
        };
        let expected = island.balls[0].velocity().as_dvec3() * (iron / (cloth + iron));
        let start = centre(&island);
        run(&mut island, &weightless(FRAME), 1.0);
        let found = centre(&island) - start;
        law(
            &format!("speed of the common centre, {substeps} substeps"),
            found.length(),
            expected.length(),
            8e-6,
        );
        let aside = (found - expected).length() / expected.length();
        law_of_error(&format!("velocity of the common centre, {substeps} substeps"), aside, 8e-6);
    }
}

/// The error of the angular momentum after a hit off the middle and at an angle, as a part of the ball's. The hit is soft
/// enough to need no further substeps, and begins at `phase` (0 to 1) of a substep.
fn angular_error(substeps: u32, phase: f32) -> f64 {
    let settings = BodySettings { substeps, iterations: 2, drag: 0.0, ..BodySettings::default() };
    let material = ClothMaterial { areal_density: 1.0, ..ClothMaterial::default() };
    let sheet = ClothBuilder::new(1.5, 1.2, 21, 17)
        .placed(Vec3::new(-0.75, 0.6, 0.0), Vec3::X, Vec3::NEG_Y)
        .material(material)
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(sheet);
    let velocity = Vec3::new(0.5, -0.3, -10.0);
    let start = Vec3::new(0.4, 0.3, 0.3) + velocity * (phase * FRAME / substeps as f32);
    let material = BallMaterial { mass: 0.6, ..BallMaterial::default() };
    let mut ball = ball(material, start, velocity);
    ball.set_spin(Vec3::new(1.0, 2.0, 3.0));
    let brought = f64::from(material.mass * start.cross(velocity).length());
    island.balls.push(ball);
    let before = angular_momentum(&island);
    run_with(&mut island, &weightless(FRAME), 0.1, |island, _| {
        assert_eq!(island.substeps(), substeps, "the comparison needs equal substeps");
    });
    (angular_momentum(&island) - before).length() / brought
}

/// Angular momentum is kept to 2 % at 16 substeps, and better in proportion with more. A single hit depends on its time
/// within a substep, so the test takes the mean over eight.
#[test]
fn the_error_of_angular_momentum_falls_with_the_substep() {
    let mean = |substeps| (0..8).map(|k| angular_error(substeps, k as f32 / 8.0)).sum::<f64>() / 8.0;
    let [at_16, at_32, at_64] = [16, 32, 64].map(mean);
    println!("{at_16} at 16 substeps, {at_32} at 32, {at_64} at 64");
    assert!(at_16 < 0.02, "{at_16} at 16 substeps");
    assert!(at_32 < 0.65 * at_16, "{at_16} at 16 substeps, {at_32} at 32");
    assert!(at_64 < 0.65 * at_32, "{at_32} at 32 substeps, {at_64} at 64");
}

/// Contacts, friction and rigid sticks do no work: kinetic energy only falls, except for the energy of sticks that a sweep
/// had left stretched.
#[test]
fn kinetic_energy_never_rises_across_a_hit() {
    for substeps in [4, 16] {
        let mut island = hit(substeps);
        let start = kinetic_energy(&island);
        let mut last = start;
        run_with(&mut island, &weightless(FRAME), 1.0, |island, index| {
            let now = kinetic_energy(island);
            assert!(now <= last + 1e-3 * start, "{last} J to {now} J at step {index}, {substeps} substeps");
            last = now;
        });
        assert!(last < 0.99 * start, "the hit must have cost energy");
    }
}

/// Two rough spinning balls hit off centre: linear and angular momentum is kept, and no energy is gained.
#[test]
fn two_balls_keep_their_momentum() {
    for friction in [0.0, 0.5] {
        let first = BallMaterial { friction, radius: 0.2, mass: 3.0, ..BallMaterial::default() };
        let second = BallMaterial { friction, radius: 0.1, mass: 1.0, ..BallMaterial::default() };
        let mut island = Island::of_ball(ball(first, Vec3::X * -1.0, Vec3::new(4.0, 0.2, 0.0)));
        island.balls.push(ball(second, Vec3::new(1.0, 0.1, 0.05), Vec3::new(-3.0, 0.0, 0.1)));
        island.balls[0].set_spin(Vec3::new(0.0, 5.0, 9.0));
        let (linear, angular) = (momentum(&island), angular_momentum(&island));
        // The scale of the hit: reduced mass, relative speed and distance of the centres.
        let scale = 0.75 * 7.0 * 0.3;
        let energy = kinetic_energy(&island);
        run(&mut island, &weightless(1.0 / 960.0), 1.0);
        let lost = (momentum(&island) - linear).length() / linear.length();
        assert!(lost < 1e-5, "{lost} of the momentum is lost");
        let lost = (angular_momentum(&island) - angular).length() / scale;
        assert!(lost < 0.01, "{lost} of the angular momentum is lost");
        assert!(kinetic_energy(&island) < 0.9 * energy, "the hit must have happened");
    }
}

/// Two equal balls head on stop dead: restitution is zero.
#[test]
fn a_head_on_hit_of_equal_balls_stops_both() {
    let material = smooth(0.2, 1.0);
    let mut island = Island::of_ball(ball(material, Vec3::X * -1.0, Vec3::X * 3.0));
    island.balls.push(ball(material, Vec3::X, Vec3::X * -3.0));
    run(&mut island, &weightless(FRAME), 1.0);
    for ball in &island.balls {
        assert!(ball.velocity().length() < 1e-3, "{}", ball.velocity());
    }
}

/// Sticks pull both ends alike: a tumbling free cloth keeps its momentum, and its rotation slows only slowly.
#[test]
fn a_tumbling_cloth_keeps_its_momentum() {
    let settings = BodySettings { drag: 0.0, substeps: 16, iterations: 1, ..BodySettings::default() };
    let mut sheet = ClothBuilder::new(1.0, 1.0, 12, 12).build(settings).expect("valid");
    let middle = Vec3::new(0.5, -0.5, 0.0);
    for i in 0..sheet.particles.len() {
        let arm = sheet.particles.position(i) - middle;
        sheet.particles.set_velocity(i, Vec3::new(1.0, 0.0, 2.0) + Vec3::new(0.3, 0.5, 2.0).cross(arm));
    }
    let mut island = Island::of_body(sheet);
    let (linear, angular) = (momentum(&island), angular_momentum(&island));
    run(&mut island, &weightless(FRAME), 2.0);
    assert!((momentum(&island) - linear).length() < 1e-5 * linear.length());
    let lost = (angular_momentum(&island) - angular).length() / angular.length();
    assert!(lost < 0.02, "{lost} of the angular momentum is lost");
}
