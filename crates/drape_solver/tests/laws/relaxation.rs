//! S8 to S11, S13 to S15: sticks at the level of whole bodies.

use drape_solver::glam::Vec3;
use drape_solver::{
    BodySettings, ClothBuilder, Edge, Environment, Island, RopeBuilder, StickKind, StickMaterial,
    StickProjection, StructuralSolve,
};

use crate::common::*;

/// The mean stretch of a hanging rope of 16 links after six seconds, with N iterations.
fn hanging_stretch(iterations: u32, projection: StickProjection) -> f64 {
    let settings = BodySettings { iterations, drag: 2.0, projection, ..bare() };
    let rope =
        RopeBuilder::new(Vec3::ZERO, Vec3::NEG_Y * 2.0, 17).pin_start().build(settings).expect("valid");
    let mut island = Island::of_body(rope);
    run(&mut island, &gravity(FRAME), 6.0);
    stretch(&island).rms
}

/// S11: N trades accuracy for time: the error falls with each doubling of the iterations.
#[test]
fn more_iterations_leave_less_stretch() {
    for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
        let errors = [1, 2, 4, 8, 16, 32].map(|n| hanging_stretch(n, projection));
        for pair in errors.windows(2) {
            assert!(pair[1] < 0.9 * pair[0], "{projection:?}: {errors:?}");
        }
    }
}

/// S11: relaxation may stop at any time; the next step continues from there until the error is gone.
#[test]
fn one_iteration_a_step_goes_on_converging() {
    let settings = BodySettings { drag: 30.0, ..bare() };
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 2.0, 17).build(settings).expect("valid");
    let mut island = Island::of_body(rope);
    for i in 0..17 {
        let stretched = particles(&island).position(i) * 1.3;
        island.bodies[0].particles.set_position(i, stretched);
    }
    let mut error = stretch(&island).rms;
    assert_close("stretch at first", error, 0.3, 1e-4);
    for _ in 0..8 {
        run(&mut island, &weightless(FRAME), 0.5);
        assert!(particles(&island).is_finite());
        let now = stretch(&island).rms;
        assert!(now < 0.8 * error || now < 1e-5, "{error} and then {now}");
        error = now;
    }
    assert!(error < 1e-2);
}

/// Lets a curtain hang for a second and a half with up to 64 iterations. Returns the iterations of the last substep, the
/// greatest stretch, and the hash.
fn hang_within(tolerance: f32) -> (u32, f64, u64) {
    let structural = StructuralSolve::Sweeps;
    let settings =
        BodySettings { substeps: 4, iterations: 64, tolerance, structural, ..BodySettings::default() };
    let curtain = ClothBuilder::new(1.0, 1.0, 24, 24).pin_edge(Edge::Top).build(settings).expect("valid");
    let mut island = Island::of_body(curtain);
    run(&mut island, &gravity(FRAME), 1.5);
    let hash = drape_solver::StateHasher::new().particles(particles(&island)).finish();
    (island.iterations_taken(), stretch(&island).max, hash)
}

/// S16: relaxation stops early when every structural stick is within the tolerance, and not before.
#[test]
fn relaxation_stops_early_within_the_tolerance() {
    let (all, stretched, bits) = hang_within(0.0);
    assert_eq!(all, 64);
    // A tolerance that is never reached changes nothing; one that is always reached stops at once.
    assert_eq!(hang_within(1e-7), (64, stretched, bits));
    assert_eq!(hang_within(1.0).0, 1);
    let (taken, stretched, _) = hang_within(0.01);
    assert!((1..64).contains(&taken), "{taken} iterations");
    assert!(stretched < 0.02, "{stretched}");
}

/// S15: a step in n substeps is n steps of one substep, to the last bit.
#[test]
fn substeps_are_smaller_steps() {
    let flag = |substeps| {
        let settings = BodySettings { substeps, ..BodySettings::default() };
        let flag = ClothBuilder::new(1.0, 1.0, 9, 9).pin_edge(Edge::Left).build(settings).expect("valid");
        Island::of_body(flag)
    };
    let (mut whole, mut parts) = (flag(8), flag(1));
    run(&mut whole, &gravity(1.0 / 64.0), 1.0);
    run(&mut parts, &gravity(1.0 / 512.0), 1.0);
    assert_eq!(particles(&whole), particles(&parts));
}

/// S15: at equal work, substeps leave less stretch than iterations.
#[test]
fn substeps_buy_more_stiffness_than_iterations() {
    let sheet = |substeps, iterations| {
        let settings = BodySettings { substeps, iterations, drag: 2.0, tethers: false, ..swept() };
        let sheet = ClothBuilder::new(1.0, 1.0, 25, 25).pin_edge(Edge::Top).build(settings).expect("valid");
        let mut island = Island::of_body(sheet);
        run(&mut island, &gravity(FRAME), 3.0);
        stretch(&island).rms
    };
    let (sub, iter) = (sheet(16, 1), sheet(1, 16));
    assert!(sub < 0.3 * iter, "{sub} with substeps, {iter} with iterations");
}

/// S9: a heavy and a light particle on a stick revolve about their common centre of mass.
#[test]
fn a_dumbbell_turns_about_its_centre_of_mass() {
    let settings = BodySettings { substeps: 8, ..bare() };
    let (heavy, light) = (4.0_f32, 1.0_f32);
    let positions = [Vec3::X * -0.2, Vec3::X * 0.8];
    let mut body = joined(&positions, &[1.0 / heavy, 1.0 / light], &[[0, 1]], settings);
    body.particles.set_velocity(0, Vec3::Y * -0.4);
    body.particles.set_velocity(1, Vec3::Y * 1.6);
    let mut island = Island::of_body(body);
    run_with(&mut island, &weightless(FRAME), 5.0, |island, _| {
        let [a, b] = [0, 1].map(|i| particles(island).position(i));
        let centre = (a * heavy + b * light) / (heavy + light);
        assert!(centre.length() < 1e-4, "{centre}");
        assert!((a.distance(b) - 1.0).abs() < 1e-4);
    });
    // Two radians a second: the period is pi.
    let speed = (particles(&island).velocity(1) - particles(&island).velocity(0)).length();
    assert_close("relative speed", speed.into(), 2.0, 0.05);
}

/// S8, S9: a pendulum swings with the period of the textbook, for any mass.
#[test]
fn a_pendulum_keeps_its_period() {
    for inverse_mass in [0.1, 10.0] {
        let angle = 0.1_f32;
        let bob = Vec3::new(angle.sin(), -angle.cos(), 0.0);
        let settings = BodySettings { substeps: 8, ..bare() };
        let body = joined(&[Vec3::ZERO, bob], &[0.0, inverse_mass], &[[0, 1]], settings);
        let mut island = Island::of_body(body);
        let mut crossings = Vec::new();
        let mut last = bob.x;
        run_with(&mut island, &gravity(FRAME), 10.0, |island, index| {
            let x = particles(island).position(1).x;
            if last > 0.0 && x <= 0.0 {
                crossings.push((index as f32 + last / (last - x)) * FRAME);
            }
            last = x;
        });
        let periods = (crossings.len() - 1) as f32;
        let period = (crossings[crossings.len() - 1] - crossings[0]) / periods;
        let expected = core::f32::consts::TAU / G.sqrt() * (1.0 + angle * angle / 16.0);
        assert_close("period", period.into(), expected.into(), 0.005);
    }
}

/// S13: bend sticks straighten an overhanging strip, and shear sticks keep a square from leaning.
#[test]
fn bend_and_shear_sticks_resist_what_they_are_named_for() {
    let droop = |bend: f32| {
        let settings = BodySettings { substeps: 16, drag: 3.0, ..BodySettings::default() };
        let mut strip = RopeBuilder::new(Vec3::ZERO, Vec3::X, 6).bend_stiffness(bend).pin(0).pin(1);
        strip = strip.damping(1.0);
        let mut island = Island::of_body(strip.build(settings).expect("valid"));
        run(&mut island, &gravity(FRAME), 6.0);
        -particles(&island).position(5).y
    };
    let (limp, stiff) = (droop(0.0), droop(1.0));
    assert!(limp > 0.7 && stiff < 0.5 * limp, "{limp} m and {stiff} m");

    let lean = |shear: f32| {
        let settings = BodySettings { substeps: 8, drag: 3.0, tethers: false, ..BodySettings::default() };
        let material = drape_solver::ClothMaterial { shear_stiffness: shear, ..Default::default() };
        let cloth = ClothBuilder::new(1.0, 1.0, 9, 9).material(material).pin_edge(Edge::Top);
        let mut island = Island::of_body(cloth.build(settings).expect("valid"));
        let mut environment = gravity(FRAME);
        environment.gravity = Vec3::new(G * 0.3, -G, 0.0);
        run(&mut island, &environment, 6.0);
        particles(&island).position(8 * 9 + 4).x - 0.5
    };
    let (loose, braced) = (lean(0.0), lean(1.0));
    assert!(loose > 0.2 && braced < 0.2 * loose, "{loose} m and {braced} m");
}

/// S13: damping along the sticks lets their stretching speed decay as `exp(-damping t)`, for every time step.
#[test]
fn damping_along_a_stick_does_not_depend_on_the_step() {
    for (dt, substeps) in [(1.0 / 30.0, 1), (FRAME, 1), (FRAME, 8), (1.0 / 240.0, 1)] {
        let material =
            StickMaterial { stiffness: 0.0, damping: 2.0, ..StickMaterial::rigid(StickKind::Structural) };
        let settings = BodySettings { substeps, ..bare() };
        let mut body = joined_by(material, &[Vec3::ZERO, Vec3::X], &[1.0, 3.0], &[[0, 1]], settings);
        body.particles.set_velocity(1, Vec3::new(1.0, 0.0, 0.0));
        let mut island = Island::of_body(body);
        let before = momentum(&island);
        run(&mut island, &weightless(dt), 0.5);
        let parting = (particles(&island).velocity(1) - particles(&island).velocity(0)).x;
        assert_close("speed", parting.into(), f64::exp(-1.0), 0.01);
        assert!((momentum(&island) - before).length() < 1e-6);
    }
}

/// S14: a stick with coinciding ends stays finite through whole steps of a body, and opens again once anything separates
/// its ends.
#[test]
fn collapsed_sticks_stay_finite_and_recover() {
    for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
        let settings = BodySettings { projection, ..BodySettings::default() };
        let cloth = ClothBuilder::new(1.0, 1.0, 8, 8).pin_edge(Edge::Top).build(settings).expect("valid");
        let mut island = Island::of_body(cloth);
        for i in 8..64 {
            island.bodies[0].particles.set_position(i, Vec3::new(0.5, -0.5, 0.0));
        }
        let environment =
            Environment { obstacles: vec![drape_solver::Obstacle::ground()].into(), ..gravity(FRAME) };
        run_with(&mut island, &environment, 2.0, |island, _| assert!(particles(island).is_finite()));
        assert!(greatest_speed(&island) < 50.0);
    }
}

/// S32: a pin reaches its target exactly at the end of the step, moves evenly over the substeps, and pulls the rest.
#[test]
fn a_pinned_particle_follows_its_target_evenly() {
    use drape_solver::step;
    let settings = BodySettings { substeps: 4, ..bare() };
    let body = joined(&[Vec3::ZERO, Vec3::NEG_Y], &[0.0, 1.0], &[[0, 1]], settings);
    let mut island = Island::of_body(body);
    let environment = gravity(FRAME);
    let target = Vec3::new(0.4, 0.2, -0.1);
    island.bodies[0].particles.set_pin_target(0, target);
    step::begin(&mut island, &environment).expect("a good step");
    step::accumulate_forces(&mut island, &environment);
    step::detect_collisions(&mut island, &environment);
    for index in 1..=4 {
        step::substep(&mut island, &environment);
        let expected = target * (index as f32 / 4.0);
        assert!((particles(&island).position(0) - expected).length() < 1e-6);
    }
    step::finish(&mut island).expect("a good step");
    assert!((particles(&island).position(0) - target).length() < 1e-6);
    // Without a new target it stays, at rest.
    run(&mut island, &environment, 0.5);
    assert!((particles(&island).position(0) - target).length() < 1e-6);
    assert_eq!(particles(&island).velocity(0), Vec3::ZERO);
    let length = particles(&island).position(1).distance(target);
    assert!((length - 1.0).abs() < 1e-3);
    // A target for a free particle has no effect.
    island.bodies[0].particles.set_pin_target(1, Vec3::splat(50.0));
    run(&mut island, &environment, FRAME);
    assert!(particles(&island).position(1).length() < 2.0);
}
