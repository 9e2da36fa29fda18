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

/// S7: half a degree below the angle of friction, nothing moves by a millimetre in two seconds.
#[test]
fn below_the_angle_of_friction_nothing_creeps() {
    for friction in COEFFICIENTS {
        let angle = friction.atan() - 0.5_f32.to_radians();
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

/// S7: half a degree above it everything slides.
#[test]
fn above_the_angle_of_friction_everything_slides() {
    for friction in COEFFICIENTS {
        let angle = friction.atan() + 0.5_f32.to_radians();
        for substeps in [1, 8] {
            for (name, body) in [
                ("particle", particle(angle, friction, substeps)),
                ("sheet", sheet(angle, friction, substeps)),
            ] {
                let way = slid(body, angle, friction, 2.0);
                assert!(way > 0.05, "{name}, friction {friction}, {substeps} substeps: {way} m");
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
                assert_close(&format!("{name}, friction {friction}"), found.into(), expected.into(), 0.02);
            }
        }
    }
}

/// S7: friction stops a slide after `v^2 / (2 mu g)` and never reverses it.
#[test]
fn a_slide_ends_after_the_distance_of_coulomb() {
    let (speed, friction) = (3.0, 0.5);
    for substeps in [1, 8] {
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
        assert_close("way", way.into(), f64::from(speed * speed / (2.0 * friction * G)), 0.04);
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
