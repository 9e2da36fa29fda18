//! Drives towards the animated pose: a damped spring from each particle to its animated place.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{
    Body, BodySettings, BuildError, FrameMotion, Island, Placement, PoseDrive, StateHasher, step,
};

use crate::common::*;

/// Lengths of a step in seconds, and substeps.
const STEPS: [(f32, u32); 9] = [
    (1.0 / 30.0, 1),
    (1.0 / 30.0, 4),
    (1.0 / 30.0, 16),
    (1.0 / 60.0, 1),
    (1.0 / 60.0, 4),
    (1.0 / 60.0, 16),
    (1.0 / 144.0, 1),
    (1.0 / 144.0, 4),
    (1.0 / 144.0, 16),
];

fn drive(angular_frequency: f32, damping_ratio: f32) -> PoseDrive {
    PoseDrive { angular_frequency, damping_ratio }
}

/// A particle at the origin that is driven to `place`.
fn driven(place: Vec3, drive: PoseDrive, substeps: u32) -> Body {
    let mut body = loose(&[Vec3::ZERO], BodySettings { substeps, ..bare() });
    body.particles.set_pose_drive(0, place, drive).expect("valid");
    body
}

/// The part of its way that a damped oscillator at rest has yet to go after `t` seconds.
fn oscillator(drive: PoseDrive, t: f64) -> f64 {
    let (w, z) = (f64::from(drive.angular_frequency), f64::from(drive.damping_ratio));
    let spread = (1.0 - z * z).abs().sqrt();
    let angle = w * spread * t;
    let envelope = libm::exp(-z * w * t);
    match z {
        _ if z < 1.0 => envelope * (libm::cos(angle) + z / spread * libm::sin(angle)),
        _ if z > 1.0 => envelope * (libm::cosh(angle) + z / spread * libm::sinh(angle)),
        _ => envelope * (1.0 + w * t),
    }
}

/// `x'' = -w^2 x - 2 z w x'`, for steps and substeps of any length. The particle starts half a substep early, as all that is
/// accelerated here: displacements are velocities half a substep ago.
#[test]
fn a_driven_particle_follows_the_damped_oscillator() {
    let mut worst = 0.0_f64;
    for (frequency, ratio) in [(3.0, 0.0), (6.0, 0.1), (6.0, 0.7), (6.0, 1.0), (6.0, 2.5)] {
        let drive = drive(frequency, ratio);
        for (dt, substeps) in STEPS {
            let mut island = Island::of_body(driven(Vec3::X, drive, substeps));
            let half = f64::from(dt) / f64::from(substeps) * 0.5;
            let mut error = 0.0_f64;
            run_with(&mut island, &weightless(dt), 3.0, |island, index| {
                let left = f64::from(1.0 - particles(island).position(0).x);
                let expected = oscillator(drive, f64::from(dt) * (index + 1) as f64 + half);
                error = error.max((left - expected).abs());
            });
            println!("law: {drive:?} in {substeps} substeps of {dt} s is {error:.1e} of the way off");
            worst = worst.max(error);
        }
    }
    println!("law: pose drives are at most {worst:.4} of the way off");
    assert!(worst < 0.007, "{worst}");
}

/// The pose swings: amplitude and phase are those of the driven oscillator, `1 + 2 i z v / w` over `1 - v^2 / w^2 + 2 i z v / w`.
#[test]
fn a_swinging_pose_is_followed_with_the_response_of_an_oscillator() {
    let (w, z, v) = (8.0_f64, 0.4_f64, 5.0_f64);
    let (ratio, damping) = (v / w, 2.0 * z * v / w);
    let stiff = 1.0 - ratio * ratio;
    let norm = stiff * stiff + damping * damping;
    let [real, imaginary] = [(stiff + damping * damping) / norm, (damping * stiff - damping) / norm];
    for (dt, substeps) in STEPS {
        let mut worst = 0.0_f64;
        let mut island = Island::of_body(driven(Vec3::ZERO, drive(w as f32, z as f32), substeps));
        for index in 1..=unless_miri((8.0 / dt) as usize, 2) {
            let t = f64::from(dt) * index as f64;
            let place = Vec3::X * libm::sin(v * t) as f32;
            island.bodies[0].particles.set_drive_place(0, place);
            step(&mut island, &weightless(dt)).expect("a good step");
            if t > 5.0 {
                let expected = real * libm::sin(v * t) + imaginary * libm::cos(v * t);
                worst = worst.max((f64::from(particles(&island).position(0).x) - expected).abs());
            }
        }
        println!("law: in {substeps} substeps of {dt} s a driven particle is {worst:.4} of a swing off");
        assert!(worst < 1.6 * f64::from(dt) / f64::from(substeps) + 0.005, "{worst}");
    }
}

/// Spring and load balance at `g / w^2`, where the particle is at rest.
#[test]
fn a_driven_particle_sags_under_gravity_by_the_same_in_all_steps() {
    for (frequency, ratio) in [(6.0, 0.5), (20.0, 1.0), (100.0, 1.0)] {
        for (dt, substeps) in STEPS {
            let mut island = Island::of_body(driven(Vec3::ZERO, drive(frequency, ratio), substeps));
            run(&mut island, &gravity(dt), 8.0);
            let (found, expected) = (-particles(&island).position(0).y, G / (frequency * frequency));
            let speed = greatest_speed(&island);
            assert!(cfg!(miri) || (found / expected - 1.0).abs() < 1e-3, "{found} m instead of {expected}");
            assert!(cfg!(miri) || speed < 1e-4, "{speed} m/s");
        }
    }
}

/// However stiff it is, a damped particle comes to its place and stays there; without damping it gains nothing.
#[test]
fn the_stiffest_drive_is_stable() {
    for ratio in [0.0, 0.01, 1.0, 30.0] {
        for (dt, substeps) in STEPS {
            let mut island = Island::of_body(driven(Vec3::X, drive(1e4, ratio), substeps));
            run_with(&mut island, &weightless(dt), 2.0, |island, _| {
                let off = (particles(island).position(0) - Vec3::X).length();
                assert!(
                    off < if ratio == 1.0 { 1e-6 } else { 1.15 },
                    "{off} m off, {ratio}, {dt} s, {substeps}"
                );
            });
        }
    }
}

/// Aboard a ship in uniform motion a particle is driven as on land.
#[test]
fn a_pose_in_uniform_motion_drives_as_one_at_rest() {
    let speed = Vec3::new(3.0, -1.0, 4.0);
    let after = |velocity: Vec3, dt: f32| {
        let mut island = Island::of_body(driven(Vec3::X, drive(7.0, 0.3), 4));
        island.bodies[0].particles.set_velocity(0, velocity);
        let steps = unless_miri((1.0 / dt) as usize, 2);
        for index in 1..=steps {
            island.bodies[0].particles.set_drive_place(0, Vec3::X + velocity * (dt * index as f32));
            step(&mut island, &gravity(dt)).expect("a good step");
        }
        particles(&island).position(0) - velocity * (dt * steps as f32)
    };
    for dt in [1.0 / 30.0, FRAME] {
        let off = after(speed, dt).distance(after(Vec3::ZERO, dt));
        assert!(off < 1e-4, "{off} m off");
    }
}

/// A particle that its frame carries along is drawn to its place in the frame, and feels nothing of the frame's motion.
#[test]
fn a_carried_particle_is_driven_as_one_at_rest() {
    let run = |way: Vec3| {
        let mut island = Island::of_body(driven(Vec3::X, drive(7.0, 0.5), 4));
        let steps = unless_miri(60, 2);
        for index in 1..=steps {
            let [from, to] = [index - 1, index].map(|count| Placement {
                translation: way * (count * count) as f32,
                rotation: Quat::IDENTITY,
            });
            let body = &mut island.bodies[0].particles;
            body.move_frame(FrameMotion::between(&from, &to));
            body.set_drive_place(0, Vec3::X + to.translation);
            step(&mut island, &weightless(FRAME)).expect("a good step");
        }
        particles(&island).position(0) - way * (steps * steps) as f32
    };
    let off = run(Vec3::new(0.001, 0.0005, 0.0)).distance(run(Vec3::ZERO));
    assert!(off < 1e-4, "{off} m off");
}

/// A drive moves no other particle of its body by a bit, and all masses alike.
#[test]
fn a_drive_concerns_its_particle_alone_whatever_its_mass() {
    let places = [Vec3::ZERO, Vec3::Y, Vec3::Z];
    let run = |frequency: f32| {
        let mut body = joined(&places, &[1.0, 1.0, 50.0], &[], bare());
        body.particles.set_velocity(1, Vec3::X);
        for i in [0, 2] {
            let place = places[i] + Vec3::X;
            body.particles.set_pose_drive(i, place, drive(frequency, 0.2)).expect("valid");
        }
        let mut island = Island::of_body(body);
        run(&mut island, &weightless(FRAME), 0.5);
        [0, 1, 2].map(|i| particles(&island).position(i) - places[i])
    };
    let ([light, other, heavy], [_, undriven, _]) = (run(9.0), run(0.0));
    assert_eq!(other, undriven);
    assert!((light - heavy).length() < 1e-5, "{light} {heavy}");
}

/// A particle at rest in its place, with a place that does not move, does not disturb a sleeping body; one that moves does.
#[test]
fn a_place_that_does_not_move_disturbs_nothing() {
    let mut body = driven(Vec3::ZERO, drive(9.0, 1.0), 1);
    let mut island = Island::of_body(body.clone());
    step(&mut island, &weightless(FRAME)).expect("a good step");
    body = island.bodies.remove(0);
    body.particles.set_drive_place(0, Vec3::ZERO);
    assert!(!body.particles.is_disturbed());
    body.particles.set_drive_place(0, Vec3::X);
    assert!(body.particles.is_disturbed());
}

#[test]
fn impossible_drives_are_refused() {
    let mut body = loose(&[Vec3::ZERO], bare());
    let before = StateHasher::new().particles(&body.particles).finish();
    for (frequency, ratio) in
        [(-1.0, 1.0), (f32::NAN, 1.0), (2e4, 1.0), (1.0, -0.1), (1.0, f32::NAN), (1.0, 2e3)]
    {
        assert!(body.particles.set_pose_drive(0, Vec3::ZERO, drive(frequency, ratio)).is_err());
    }
    let error = body.particles.set_pose_drive(0, Vec3::X * f32::NAN, drive(1.0, 1.0));
    assert!(matches!(error, Err(BuildError::NotFinite { .. })), "{error:?}");
    assert!(!body.particles.follows_pose());
    assert_eq!(StateHasher::new().particles(&body.particles).finish(), before);
}
