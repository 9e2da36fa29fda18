//! Free flight, swings, ropes, drag and wind.

use core::f64::consts::TAU;

use drape_gpu::{GpuError, GpuWorld};
use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, ClothBuilder, Environment, RopeBuilder, Wind};

use crate::common::*;

/// A thrown particle flies on Galilei's parabola. A Verlet displacement is the mean velocity of a substep, so that the fall is half a
/// substep ahead: `y = -g t (t + h) / 2`.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_thrown_particle_flies_on_a_parabola() {
    for count in [3, 3000] {
        let places: Vec<Vec3> = (0..count).map(|i| Vec3::X * i as f32 * 0.01).collect();
        let settings = BodySettings { substeps: 8, ..bare() };
        let mut body = joined(&places, &vec![2.0; count], &[], settings);
        (0..count).for_each(|i| body.particles.set_velocity(i, Vec3::new(3.0, 5.0, -1.0)));
        let (mut world, id) = world_of(&body);
        run(&mut world, &gravity(), 60);
        let h = FRAME / 8.0;
        let flown = Vec3::new(3.0, 5.0 - 0.5 * G * (1.0 + h), -1.0);
        for (start, end) in places.iter().zip(positions(&world, id)) {
            assert!((end - *start - flown).length() < 2e-4, "{count}: {} instead of {flown}", end - *start);
        }
    }
}

/// The velocity of a body counts for steps of any length: displacements are rescaled.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_change_of_the_step_keeps_velocities() {
    for count in [3, 3000] {
        let mut body =
            joined(&vec![Vec3::ZERO; count], &vec![1.0; count], &[], BodySettings { substeps: 4, ..bare() });
        (0..count).for_each(|i| body.particles.set_velocity(i, Vec3::X * 6.0));
        let (mut world, id) = world_of(&body);
        let still = Environment { gravity: Vec3::ZERO, ..gravity() };
        run(&mut world, &still, 10);
        run(&mut world, &Environment { dt: FRAME / 2.0, ..still.clone() }, 20);
        run(&mut world, &still, 10);
        let end = positions(&world, id);
        assert!(end.iter().all(|end| (end.x - 3.0).abs() < 1e-4), "{}", end[0]);
    }
}

/// The velocity of a body counts for any number of substeps too, and pins stay where they are. A change once gave its status another speed at once.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_change_of_the_substeps_keeps_velocities() {
    for count in [3, 3000] {
        let mut inverse_masses = vec![1.0; count];
        inverse_masses[0] = 0.0;
        let settings = BodySettings { substeps: 4, ..bare() };
        let mut body = joined(&vec![Vec3::ZERO; count], &inverse_masses, &[], settings);
        (1..count).for_each(|i| body.particles.set_velocity(i, Vec3::X * 6.0));
        let (mut world, id) = world_of(&body);
        let still = Environment { gravity: Vec3::ZERO, ..gravity() };
        world.set_substeps(id, 8).expect("it has not been stepped");
        for (substeps, steps) in [(8, 5), (2, 10), (1, 0), (16, 5)] {
            world.set_substeps(id, substeps).expect("a body");
            run(&mut world, &still, steps);
        }
        let speed =
            |world: &GpuWorld| world.read_status(id).expect("a body").expect("stepped").greatest_speed;
        assert!((speed(&world) - 6.0).abs() < 1e-3);
        world.set_substeps(id, 4).expect("a body");
        assert!((speed(&world) - 6.0).abs() < 1e-3, "that of the last step, in which it had more");
        let end = positions(&world, id);
        assert!(end[1..].iter().all(|end| (end.x - 2.0).abs() < 1e-4), "{}", end[1]);
        assert_eq!(end[0], Vec3::ZERO);
        assert!(matches!(world.set_substeps(id, 0), Err(GpuError::Settings(_))));
        run(&mut world, &still, 10);
        assert!((positions(&world, id)[1].x - 3.0).abs() < 1e-4, "a number that is refused changes nothing");
    }
}

/// The wind finds the same velocity after a change of substeps and of the step: sheets that drift in it stay together.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_change_of_the_substeps_and_the_step_is_not_felt_by_the_wind() {
    for n in [8, 50] {
        let settings = BodySettings { substeps: 8, drag: 0.0, tethers: false, ..BodySettings::default() };
        let sheet = ClothBuilder::new(1.0, 1.0, n, n).build(settings).expect("valid");
        let mut world = GpuWorld::new(gpu());
        let [changed, kept] = [0, 1].map(|_| world.add(&sheet).expect("a body"));
        let wind = Wind::new(Vec3::new(3.0, 1.0, 5.0));
        let windy = Environment { gravity: Vec3::ZERO, wind, ..gravity() };
        run(&mut world, &windy, 20);
        world.set_substeps(changed, 2).expect("a body");
        run(&mut world, &Environment { dt: FRAME / 2.0, ..windy.clone() }, 1);
        let [changed, kept] = [changed, kept].map(|id| centre(&positions(&world, id)));
        let way = (kept - centre(&sheet.particles.positions().collect::<Vec<_>>())).length();
        assert!(way > 0.2, "they drift: {way} m");
        assert!(changed.distance(kept) < 1e-4 * way, "{n}: {changed} instead of {kept}");
    }
}

/// A small swing takes `T = 2 pi sqrt(l / g)` (Huygens 1673).
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_pendulum_swings_in_its_period() {
    let angle = 0.1_f32;
    let bob = Vec3::new(0.099_833_42, -0.995_004_2, 0.0);
    let body = joined(&[Vec3::ZERO, bob], &[0.0, 1.0], &[[0, 1]], BodySettings { substeps: 16, ..bare() });
    let (mut world, id) = world_of(&body);
    let (mut crossings, mut before) = (Vec::new(), bob.x);
    for step in 1..=60 * 7 {
        run(&mut world, &gravity(), 1);
        let x = positions(&world, id)[1].x;
        if before > 0.0 && x <= 0.0 {
            crossings.push(f64::from(FRAME) * (f64::from(step) - f64::from(x / (x - before))));
        }
        before = x;
    }
    let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    // A swing of `angle` takes longer by a sixteenth of its square.
    let expected = TAU / f64::from(G).sqrt() * (1.0 + f64::from(angle).powi(2) / 16.0);
    assert!((period / expected - 1.0).abs() < 0.01, "{period} s instead of {expected} s");
}

/// A pinned rope whose end was brought nearer hangs as the catenary `y = a cosh(x / a)`, `2 a sinh(d / 2a) = L`.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_pinned_rope_hangs_as_a_catenary() {
    let (length, span) = (3.0_f64, 2.0_f64);
    let links = 31;
    let settings = BodySettings { substeps: 16, iterations: 4, drag: 3.0, ..bare() };
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * length as f32, links + 1).pin_start().pin_end();
    let (mut world, id) = world_of(&rope.build(settings).expect("valid"));
    for step in 1..=120 {
        let end = length + (span - length) * f64::from(step) / 120.0;
        world.set_pin_target(id, links, Vec3::X * end as f32).expect("a pin");
        run(&mut world, &gravity(), 1);
    }
    run(&mut world, &gravity(), 12 * 60);
    let (mut low, mut high) = (0.01, 1e4);
    for _ in 0..200 {
        let a = 0.5 * (low + high);
        // A flatter curve (larger a) is shorter.
        if 2.0 * a * (span / (2.0 * a)).sinh() > length { low = a } else { high = a }
    }
    let sag = low * ((span / (2.0 * low)).cosh() - 1.0);
    let end = positions(&world, id);
    let lowest = end.iter().map(|place| -f64::from(place.y)).fold(0.0, f64::max);
    assert!((lowest / sag - 1.0).abs() < 0.02, "sag of {lowest} m instead of {sag} m");
    assert!(
        (f64::from(end[links as usize].x) - span).abs() < 1e-4,
        "the pin came to {}",
        end[links as usize]
    );
}

/// Drag `c` in 1/s leads to the speed `g / c`.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn drag_leads_to_the_terminal_velocity() {
    for count in [1, 1500] {
        let settings = BodySettings { drag: 2.0, substeps: 4, ..bare() };
        let (mut world, id) = world_of(&joined(&vec![Vec3::ZERO; count], &vec![1.0; count], &[], settings));
        run(&mut world, &gravity(), 400);
        let before = positions(&world, id)[count - 1].y;
        run(&mut world, &gravity(), 60);
        let speed = before - positions(&world, id)[count - 1].y;
        assert!((speed / (G / 2.0) - 1.0).abs() < 2e-3, "{speed} m/s");
    }
}

/// A level sheet without drag of its own rises in an updraught, and falls in one that is too weak: at `v^2 = 2 m g / (rho c_d A)` the air
/// carries it.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn an_updraught_carries_a_level_sheet() {
    for n in [12, 40] {
        let body = level(n, Vec3::ZERO, BodySettings { drag: 0.0, ..BodySettings::default() });
        let areal_density = 0.25;
        let hover = (2.0 * areal_density * G / (1.2 * 1.2)).sqrt();
        let rises = |speed: f32| {
            let (mut world, id) = world_of(&body);
            run(&mut world, &Environment { wind: Wind::new(Vec3::Y * speed), ..gravity() }, 30);
            centre(&positions(&world, id)).y
        };
        let rest = rises(hover);
        // Without air it would fall by 1.2 m. It bends a little, as its corners have more mass than air.
        assert!(rest.abs() < 0.08, "{n}: at {hover} m/s it moved by {rest} m");
        let [up, down] = [1.2, 0.8].map(|part| rises(part * hover));
        assert!(up > 0.05 && down < -0.05, "{n}: {up} m, {down} m");
    }
}

/// Sticks push their ends apart alike: a sheet that was thrown with a spin keeps its momentum.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn sticks_keep_momentum() {
    for n in [16, 50] {
        let mut body = level(n, Vec3::ZERO, BodySettings { drag: 0.0, ..BodySettings::default() });
        let mass = |i: usize| 1.0 / f64::from(body.particles.inverse_mass(i));
        let masses: Vec<f64> = (0..body.particles.len()).map(mass).collect();
        for i in 0..body.particles.len() {
            let arm = body.particles.position(i) - Vec3::new(0.5, 0.0, 0.5);
            body.particles
                .set_velocity(i, Vec3::new(1.0, 2.0, 0.5) + Vec3::Y.cross(arm) * 3.0 + Vec3::Y * arm.x);
        }
        let centre_of_mass = |positions: &[Vec3]| {
            let sum = positions.iter().zip(&masses).map(|(place, mass)| place.as_dvec3() * *mass);
            sum.sum::<drape_solver::glam::DVec3>() / masses.iter().sum::<f64>()
        };
        let before = centre_of_mass(&body.particles.positions().collect::<Vec<_>>());
        let (mut world, id) = world_of(&body);
        run(&mut world, &Environment { gravity: Vec3::ZERO, ..gravity() }, 120);
        let moved = centre_of_mass(&positions(&world, id)) - before;
        let expected = drape_solver::glam::DVec3::new(2.0, 4.0, 1.0);
        assert!((moved - expected).length() < 5e-4, "{n}: moved by {moved}");
    }
}

/// A pin with a target goes there in one step, and stays.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn pins_go_to_their_targets_and_stay() {
    for n in [10, 40] {
        let cloth = ClothBuilder::new(1.0, 1.0, n, n)
            .placed(Vec3::splat(100.0), Vec3::X, Vec3::NEG_Y)
            .pin(0)
            .pin(n - 1);
        let (mut world, id) = world_of(&cloth.build(BodySettings::default()).expect("valid"));
        run(&mut world, &gravity(), 5);
        let target = Vec3::new(100.3, 100.1, 99.8);
        let other = target + Vec3::X;
        // The last one counts.
        for (pin, place) in [(0, other), (n - 1, other), (0, target)] {
            world.set_pin_target(id, pin, place).expect("a pin");
        }
        run(&mut world, &gravity(), 1);
        assert!(positions(&world, id)[0].distance(target) < 2e-5);
        assert!(positions(&world, id)[n as usize - 1].distance(other) < 2e-5);
        run(&mut world, &gravity(), 20);
        assert!(positions(&world, id)[0].distance(target) < 2e-5);
        assert!(world.set_pin_target(id, 1, target).is_err(), "it is not pinned");
    }
}
