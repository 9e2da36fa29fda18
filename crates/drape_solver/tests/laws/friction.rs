//! S7: Coulomb friction, on an incline.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{Body, ClothBuilder, Environment, Island, Obstacle, Placement, Shape, SolverSettings};

use crate::common::*;

const COEFFICIENTS: [f32; 3] = [0.2, 0.5, 1.0];

/// An incline about the Z axis, downhill towards +X, and the way down.
fn incline(angle: f32, friction: f32) -> (Obstacle, Vec3) {
    let rotation = Quat::from_rotation_z(-angle);
    let placement = Placement { rotation, ..Placement::default() };
    let plane = Obstacle::new(Shape::HalfSpace { normal: Vec3::Y }, placement, friction).expect("valid");
    (plane, rotation * Vec3::X)
}

/// How far downhill the middle of `body` goes in `seconds` on an incline of `angle`, both surfaces of
/// coefficient `friction`.
fn slid(body: Body, angle: f32, friction: f32, seconds: f32) -> f32 {
    let (plane, downhill) = incline(angle, friction);
    let environment = Environment { obstacles: vec![plane].into(), ..gravity(FRAME) };
    let mut island = Island::of_body(body);
    let middle =
        |island: &Island| particles(island).positions().sum::<Vec3>() / particles(island).len() as f32;
    let start = middle(&island);
    run(&mut island, &environment, seconds);
    (middle(&island) - start).dot(downhill)
}

fn particle(angle: f32, friction: f32, substeps: u32) -> Body {
    let normal = Quat::from_rotation_z(-angle) * Vec3::Y;
    let settings = SolverSettings { friction, substeps, iterations: 2, thickness: 0.005, ..bare() };
    loose(&[normal * 0.005], settings)
}

fn sheet(angle: f32, friction: f32, substeps: u32) -> Body {
    let rotation = Quat::from_rotation_z(-angle);
    let settings =
        SolverSettings { friction, substeps, iterations: 2, thickness: 0.005, tethers: true, ..bare() };
    ClothBuilder::new(0.8, 0.8, 9, 9)
        .placed(rotation * Vec3::Y * 0.005, rotation * Vec3::X, Vec3::Z)
        .build(settings)
        .expect("valid")
}

/// S7: a fifth of a degree below the angle of friction, nothing moves by a millimetre in two seconds.
#[test]
fn below_the_angle_of_friction_nothing_creeps() {
    for friction in COEFFICIENTS {
        let angle = friction.atan() - 0.2_f32.to_radians();
        for substeps in [1, 8] {
            for (name, body) in [
                ("particle", particle(angle, friction, substeps)),
                ("sheet", sheet(angle, friction, substeps)),
            ] {
                let way = slid(body, angle, friction, 2.0);
                assert!(way.abs() < 1e-3, "{name}, friction {friction}, {substeps} substeps: {way} m");
            }
        }
    }
}

/// S7: a fifth of a degree above it everything slides.
#[test]
fn above_the_angle_of_friction_everything_slides() {
    for friction in COEFFICIENTS {
        let angle = friction.atan() + 0.2_f32.to_radians();
        for substeps in [1, 8] {
            for (name, body) in [
                ("particle", particle(angle, friction, substeps)),
                ("sheet", sheet(angle, friction, substeps)),
            ] {
                let way = slid(body, angle, friction, 2.0);
                assert!(way > 0.03, "{name}, friction {friction}, {substeps} substeps: {way} m");
            }
        }
    }
}

/// S7: sliding, the acceleration is `g (sin - mu cos)`.
#[test]
fn sliding_accelerates_by_what_friction_leaves_of_gravity() {
    for friction in [0.0, 0.2, 0.5] {
        for substeps in [1, 8] {
            let angle = 40.0_f32.to_radians();
            let h = FRAME / substeps as f32;
            let expected = G * (angle.sin() - friction * angle.cos());
            let bodies = [
                ("particle", particle(angle, friction, substeps)),
                ("sheet", sheet(angle, friction, substeps)),
            ];
            for (name, body) in bodies {
                // The discrete way of a constant acceleration in n substeps is a h^2 n (n + 1) / 2.
                let found = slid(body, angle, friction, 1.0) * 2.0 / (1.0 + h);
                let case = format!("{name}, friction {friction}, {substeps} substeps");
                law(&format!("incline, {case}"), found.into(), expected.into(), 2e-6);
            }
        }
    }
}

/// S7: friction stops a slide after `v^2 / (2 mu g)` and never reverses it.
#[test]
fn a_slide_ends_after_the_distance_of_coulomb() {
    let (speed, friction) = (3.0, 0.5);
    for (substeps, tolerance) in [(1, 0.041), (8, 5.2e-3)] {
        let settings = SolverSettings { substeps, friction, iterations: 2, ..bare() };
        let mut body = loose(&[Vec3::ZERO], settings);
        body.particles.set_velocity(0, Vec3::X * speed);
        let mut island = Island::of_body(body);
        let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
        run_with(&mut island, &environment, 2.0, |island, _| {
            assert!(particles(island).velocity(0).x >= 0.0, "never reversed");
        });
        assert_eq!(particles(&island).velocity(0).x, 0.0, "at rest");
        let way = particles(&island).position(0).x;
        let expected = f64::from(speed * speed / (2.0 * friction * G));
        law(&format!("way to a stop, {substeps} substeps"), way.into(), expected, tolerance);
    }
}

/// S7: two surfaces in contact use the mean of their coefficients.
#[test]
fn the_coefficients_of_two_surfaces_are_averaged() {
    let angle = 20.0_f32.to_radians();
    let way = |own: f32, planes: f32| {
        let (plane, _) = incline(angle, planes);
        let environment = Environment { obstacles: vec![plane].into(), ..gravity(FRAME) };
        let mut island = Island::of_body(particle(angle, own, 4));
        run(&mut island, &environment, 1.0);
        particles(&island).position(0).length()
    };
    let even = way(0.2, 0.2);
    assert!((way(0.4, 0.0) - even).abs() < 1e-4 && (way(0.0, 0.4) - even).abs() < 1e-4);
    assert!(way(0.0, 0.0) > even + 0.1);
}

/// S7: between the angles of static and of kinetic friction, what lies still stays, and what slides goes on sliding.
#[test]
fn static_friction_holds_what_does_not_slide_yet() {
    let (kinetic, sticking) = (0.3_f32, 0.6_f32);
    let angle = 0.5 * (kinetic.atan() + sticking.atan());
    let body = |speed: f32| {
        let (_, downhill) = incline(angle, 0.0);
        let mut body = particle(angle, kinetic, 8);
        body.settings.static_friction = sticking;
        body.particles.set_velocity(0, downhill * speed);
        body
    };
    let (plane, downhill) = incline(angle, kinetic);
    let plane = plane.with_static_friction(sticking).expect("valid");
    let environment = Environment { obstacles: vec![plane].into(), ..gravity(FRAME) };
    let after = |speed: f32| {
        let mut island = Island::of_body(body(speed));
        run(&mut island, &environment, 1.0);
        particles(&island).velocity(0).dot(downhill)
    };
    assert!(after(0.0).abs() < 1e-6, "it holds");
    let expected = 1.0 + G * (angle.sin() - kinetic * angle.cos());
    law("speed after a second's slide", after(1.0).into(), expected.into(), 1e-5);
}
