//! S4, S5, S6: projection out of obstacles, and the box.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::{Cuboid, SharedShape};
use drape_solver::{BodySettings, Environment, Island, Obstacle, Placement, Shape};

use crate::common::*;

/// The box (0, 0, 0)-(1000, 1000, 1000) of the founding paper's first scene.
fn founding_box() -> Obstacle {
    obstacle(Shape::Container { half_extents: Vec3::splat(500.0) }, Vec3::splat(500.0), 0.0)
}

fn inside(point: Vec3) -> bool {
    point.cmpge(Vec3::splat(-1e-4)).all() && point.cmple(Vec3::splat(1000.0 + 1e-4)).all()
}

/// S4: the implicit velocity loses its normal part: no rebound at any speed and time step.
#[test]
fn projection_leaves_no_normal_velocity() {
    for (substeps, iterations) in [(1, 1), (4, 3), (16, 1)] {
        for speed in [0.5, 5.0, 25.0] {
            let settings = BodySettings { substeps, iterations, ..bare() };
            let mut body = loose(&[Vec3::Y * 0.3], settings);
            body.particles.set_velocity(0, Vec3::new(1.0, -speed, 0.0));
            let mut island = Island::of_body(body);
            let environment = Environment { obstacles: vec![ice()].into(), ..weightless(FRAME) };
            run_with(&mut island, &environment, 1.0, |island, _| {
                let particles = particles(island);
                assert!(particles.position(0).y > -1e-6, "it is on or above the ground after every step");
                assert!(particles.velocity(0).y < 1e-4, "no rebound from {speed} m/s");
            });
            let velocity = particles(&island).velocity(0);
            assert!((velocity - Vec3::X).length() < 1e-4, "{velocity} from {speed} m/s");
        }
    }
}

/// S4: a penetrating particle goes to the nearest point of the surface.
#[test]
fn projection_goes_to_the_nearest_point_of_the_surface() {
    let turned = |translation: Vec3| Placement { translation, rotation: Quat::from_rotation_z(0.5) };
    let cases = [
        (Shape::Sphere { radius: 2.0 }, Vec3::new(0.6, 0.8, 0.0), Vec3::new(1.2, 1.6, 0.0)),
        (Shape::Cuboid { half_extents: Vec3::ONE }, Vec3::new(0.9, 0.2, -0.3), Vec3::new(1.0, 0.2, -0.3)),
        (
            Shape::Capsule { half_length: 1.0, radius: 0.5 },
            Vec3::new(0.0, -0.7, 0.1),
            Vec3::new(0.0, -0.7, 0.5),
        ),
        // Its side leans by a slope of three to four.
        (
            Shape::TaperedCapsule { half_length: 1.0, bottom_radius: 1.7, top_radius: 0.5 },
            Vec3::new(0.4, 0.3, 0.0),
            Vec3::new(0.88, 0.66, 0.0),
        ),
        (Shape::HalfSpace { normal: Vec3::X }, Vec3::new(-0.2, 3.0, 1.0), Vec3::new(0.0, 3.0, 1.0)),
        (Shape::Parry(SharedShape::cylinder(1.0, 0.5)), Vec3::new(0.4, 0.1, 0.0), Vec3::new(0.5, 0.1, 0.0)),
    ];
    for (shape, start, end) in cases {
        let name = format!("{shape:?}");
        let placement = turned(Vec3::new(3.0, 1.0, -2.0));
        let world = |local: Vec3| placement.rotation * local + placement.translation;
        let body = loose(&[world(start)], bare());
        let obstacles = vec![Obstacle::new(shape, placement, 0.0).expect("valid")];
        let mut island = Island::of_body(body);
        run(&mut island, &Environment { obstacles: obstacles.into(), ..weightless(FRAME) }, FRAME);
        let found = particles(&island).position(0);
        assert!((found - world(end)).length() < 1e-5, "{name}: {found} and not {}", world(end));
    }
}

/// S4: cloth keeps its thickness from what it touches, on every kind of shape.
#[test]
fn cloth_keeps_its_thickness() {
    let cube = Cuboid::new(Vec3::ONE).to_trimesh();
    let shapes = [
        Shape::Sphere { radius: 1.0 },
        Shape::Cuboid { half_extents: Vec3::ONE },
        Shape::Capsule { half_length: 0.5, radius: 0.5 },
        Shape::TaperedCapsule { half_length: 0.5, bottom_radius: 0.7, top_radius: 0.5 },
        Shape::HalfSpace { normal: Vec3::Y },
        Shape::Parry(SharedShape::cylinder(1.0, 0.6)),
        Shape::from_parry(SharedShape::trimesh(cube.0, cube.1).expect("a box")).expect("valid"),
    ];
    for shape in shapes {
        let name = format!("{shape:?}");
        let settings = BodySettings { thickness: 0.02, ..bare() };
        let mut island = Island::of_body(loose(&[Vec3::new(0.01, 1.3, 0.02)], settings));
        let obstacles = vec![obstacle(shape.clone(), Vec3::ZERO, 0.0)];
        let mut environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
        environment.gravity = Vec3::NEG_Y;
        run(&mut island, &environment, 0.9);
        let height = particles(&island).position(0).y;
        let top = match shape {
            Shape::HalfSpace { .. } => 0.0,
            _ => 1.0,
        };
        let expected = if top == 0.0 { height } else { top + 0.02 };
        assert!((height - expected).abs() < 2e-3, "{name}: at {height}");
    }
}

/// S5: componentwise min and max confine particles, also at edges and corners.
#[test]
fn the_box_is_componentwise_min_and_max() {
    let mut dice = Dice::new(5);
    let (mut starts, mut velocities) = (Vec::new(), Vec::new());
    for _ in 0..200 {
        starts.push(dice.vector(480.0) + 500.0);
        velocities.push(dice.vector(60.0) * 600.0);
    }
    let mut body = loose(&starts, bare());
    for (i, &velocity) in velocities.iter().enumerate() {
        body.particles.set_velocity(i, velocity);
    }
    let mut island = Island::of_body(body);
    let environment = Environment { obstacles: vec![founding_box()].into(), ..weightless(FRAME) };
    run(&mut island, &environment, FRAME);
    let mut corners = 0;
    for (i, (&start, &velocity)) in starts.iter().zip(&velocities).enumerate() {
        let free = start + velocity * FRAME;
        let expected = free.clamp(Vec3::ZERO, Vec3::splat(1000.0));
        let found = particles(&island).position(i);
        assert!((found - expected).length() < 2e-3, "{free} goes to {found} and not {expected}");
        let moved = particles(&island).velocity(i) * FRAME;
        assert!((moved - (expected - start)).length() < 2e-3, "the outward part of the velocity is gone");
        corners += i32::from((free - expected).abs().cmpgt(Vec3::splat(1.0)).bitmask().count_ones() > 1);
    }
    assert!(corners > 20, "edges and corners must be among the cases, but are only {corners}");
}

/// S5: a particle that starts outside on several axes is inside after the first step, and is not thrown.
#[test]
fn the_box_takes_in_what_starts_outside() {
    let starts = [Vec3::new(-50.0, 500.0, 500.0), Vec3::new(1100.0, -3.0, 2000.0), Vec3::splat(-700.0)];
    for (substeps, iterations) in [(1, 1), (8, 2)] {
        let settings = BodySettings { substeps, iterations, ..bare() };
        let mut island = Island::of_body(loose(&starts, settings));
        let environment = Environment { obstacles: vec![founding_box()].into(), ..weightless(FRAME) };
        run(&mut island, &environment, FRAME);
        for (i, start) in starts.iter().enumerate() {
            let expected = start.clamp(Vec3::ZERO, Vec3::splat(1000.0));
            assert!((particles(&island).position(i) - expected).length() < 2e-3);
        }
        run(&mut island, &environment, 1.0);
        for (i, start) in starts.iter().enumerate() {
            let expected = start.clamp(Vec3::ZERO, Vec3::splat(1000.0));
            assert!((particles(&island).position(i) - expected).length() < 2e-3, "it stays at the wall");
        }
    }
}

/// S5: the founding scene: particles with random velocities under gravity stay in the box and end on its floor.
#[test]
fn particles_in_the_box_never_leave_it_and_settle_on_its_floor() {
    let mut dice = Dice::new(55);
    let starts: Vec<Vec3> = (0..100).map(|_| dice.vector(500.0) + 500.0).collect();
    let mut body = loose(&starts, BodySettings { drag: 0.603, ..bare() });
    for i in 0..100 {
        body.particles.set_velocity(i, dice.vector(200.0));
    }
    let mut island = Island::of_body(body);
    let environment = Environment { obstacles: vec![founding_box()].into(), ..gravity(FRAME) };
    run_with(&mut island, &environment, 120.0, |island, _| {
        assert!(particles(island).positions().all(inside));
    });
    assert!(particles(&island).positions().all(|p| p.y < 1e-3), "all on the floor");
}

/// S12: two particles, a stick of rest length 100 and the box of S5: both constraints hold after relaxation.
#[test]
fn the_stick_and_the_box_hold_together() {
    let mut dice = Dice::new(12);
    for case in 0..50 {
        // A stretched or compressed stick flies outwards near or beyond a wall, an edge or a corner.
        let middle = Vec3::new(dice.unit(), dice.unit(), dice.unit()).round() * 1000.0 + dice.vector(60.0);
        let half = dice.vector(1.0).normalize() * (30.0 + 50.0 * dice.unit());
        let settings = BodySettings { iterations: 16, ..bare() };
        let rest = [Vec3::ZERO, Vec3::X * 100.0];
        let mut body = joined(&rest, &[1.0, 0.5], &[[0, 1]], settings);
        body.particles.set_position(0, middle - half);
        body.particles.set_position(1, middle + half);
        let outwards = (middle - 500.0) * 0.5;
        body.particles.set_velocity(0, outwards);
        body.particles.set_velocity(1, outwards);
        let mut island = Island::of_body(body);
        let environment = Environment { obstacles: vec![founding_box()].into(), ..gravity(FRAME) };
        run_with(&mut island, &environment, 5.0, |island, index| {
            let [a, b] = [0, 1].map(|i| particles(island).position(i));
            assert!(inside(a) && inside(b), "case {case}: {a} and {b}");
            if index > 10 {
                assert!((a.distance(b) - 100.0).abs() < 0.1, "case {case}: length {}", a.distance(b));
            }
        });
    }
}
