//! Moving obstacles push and carry cloth, and do not pass through it.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{BodySettings, ClothBuilder, Edge, Environment, Island, Placement, Shape};

use crate::common::*;

const THICKNESS: f32 = 0.005;

fn sheet(pinned: bool) -> Island {
    let mut sheet =
        ClothBuilder::new(1.5, 1.5, 25, 25).placed(Vec3::new(-0.75, 0.75, 0.0), Vec3::X, Vec3::NEG_Y);
    if pinned {
        sheet = sheet.pin_edge(Edge::Top);
    }
    Island::of_body(
        sheet.build(BodySettings { thickness: THICKNESS, ..BodySettings::default() }).expect("valid"),
    )
}

/// A moving sphere pushes a loose sheet along, and stays on its side of it.
#[test]
fn a_moving_sphere_pushes_a_sheet_ahead() {
    let radius = 0.3;
    let mut island = sheet(false);
    let mut environment = weightless(FRAME);
    environment.obstacles = vec![obstacle(Shape::Sphere { radius }, Vec3::Z * -0.4, 0.5)].into();
    for index in 1..=60 {
        let centre = Vec3::Z * (-0.4 + 2.0 * FRAME * index as f32);
        environment.obstacles[0].move_to(Placement::at(centre), FRAME);
        drape_solver::step(&mut island, &environment).expect("a good step");
        for (i, position) in particles(&island).positions().enumerate() {
            let depth = radius + THICKNESS - position.distance(centre);
            assert!(depth < 1e-3, "particle {i} is {depth} m inside at step {index}");
        }
    }
    // The middle of the sheet stays on the front of the sphere.
    let middle = particles(&island).position(12 * 25 + 12);
    let front = -0.4 + 2.0 + radius + THICKNESS;
    assert!((middle.z - front).abs() < 0.05, "{middle} with the sphere's front at {front}");
    let speed = particles(&island).velocity(12 * 25 + 12).z;
    assert!((1.0..3.0).contains(&speed), "it goes at about the sphere's speed: {speed}");
}

/// An obstacle moves at 5 m/s through a hanging curtain. No particle ends a step inside it, and none is thrown away.
#[test]
fn a_fast_obstacle_leaves_no_particle_inside() {
    let radius = 0.25;
    let cuboid = Shape::Cuboid { half_extents: Vec3::splat(radius) };
    let capsule = Shape::Capsule { half_length: 0.2, radius };
    let tapered = Shape::TaperedCapsule { half_length: 0.2, bottom_radius: radius, top_radius: 0.15 };
    for shape in [Shape::Sphere { radius }, capsule, tapered, cuboid] {
        let mut island = sheet(true);
        let mut environment = gravity(FRAME);
        environment.obstacles = vec![obstacle(shape.clone(), Vec3::new(0.0, -0.2, -1.0), 0.3)].into();
        for index in 1..=36 {
            let centre = Vec3::new(0.0, -0.2, -1.0 + 5.0 * FRAME * index as f32);
            environment.obstacles[0].move_to(Placement::at(centre), FRAME);
            drape_solver::step(&mut island, &environment).expect("a good step");
            for (i, position) in particles(&island).positions().enumerate() {
                if particles(&island).is_pinned(i) {
                    continue;
                }
                // Friction runs last, and drags corners of faces around an edge.
                let depth = THICKNESS - distance(&shape, position - centre);
                assert!(
                    depth < 0.5 * THICKNESS,
                    "{shape:?}: particle {i} is {depth} m inside at step {index}"
                );
            }
            let speed = greatest_speed(&island);
            assert!(speed < 25.0, "{shape:?}: {speed} m/s at step {index}");
        }
    }
}

/// A rotating paddle sweeps particles along at the speed of its surface.
#[test]
fn a_turning_paddle_sweeps_particles_along() {
    let settings = BodySettings { substeps: 8, ..bare() };
    let mut island = Island::of_body(loose(&[Vec3::new(1.0, 0.0, -0.15)], settings));
    let mut environment = weightless(FRAME);
    let half_extents = Vec3::new(2.0, 1.0, 0.1);
    environment.obstacles = vec![obstacle(Shape::Cuboid { half_extents }, Vec3::ZERO, 0.0)].into();
    let rate = 3.0;
    for index in 1..=15 {
        let rotation = Quat::from_rotation_y(rate * FRAME * index as f32);
        environment.obstacles[0].move_to(Placement { rotation, ..Placement::default() }, FRAME);
        drape_solver::step(&mut island, &environment).expect("a good step");
    }
    // Without friction the surface at first gives it the speed `rate * distance` along its normal.
    let particle = particles(&island);
    assert!(particle.velocity(0).length() > 0.9 * rate, "{}", particle.velocity(0));
    let local = Quat::from_rotation_y(-rate * FRAME * 15.0) * particle.position(0);
    assert!(local.z < -0.1 + 1e-4, "it was not passed through: {local}");
}

/// An obstacle that stands still for one step after moving no longer carries anything.
#[test]
fn an_obstacle_that_stops_carries_no_further() {
    let mut ground = drape_solver::Obstacle::ground();
    ground.move_to(Placement::at(Vec3::X * 0.1), FRAME);
    assert!(ground.is_moving());
    ground.move_to(Placement::at(Vec3::X * 0.1), FRAME);
    assert!(!ground.is_moving());
    let mut island = Island::of_body(loose(&[Vec3::ZERO], BodySettings { friction: 0.5, ..bare() }));
    run(&mut island, &Environment { obstacles: vec![ground].into(), ..gravity(FRAME) }, 1.0);
    assert!(particles(&island).position(0).length() < 1e-6);
}

/// A ball pushes at a sheet of two faces close to its pinned edge: a corner that hangs on the far end of that lever is
/// not thrown.
#[test]
fn a_push_beside_pinned_corners_does_not_throw_the_free_one() {
    let settings = BodySettings { thickness: THICKNESS, ..BodySettings::default() };
    let sheet = ClothBuilder::new(1.0, 1.0, 2, 2).placed(Vec3::ZERO, Vec3::X, Vec3::Z).pin_edge(Edge::Top);
    let mut island = Island::of_body(sheet.build(settings).expect("valid"));
    let mut environment = weightless(FRAME);
    let radius = 0.05;
    let ball = |y: f32| Vec3::new(0.5, y, 0.05);
    environment.obstacles = vec![obstacle(Shape::Sphere { radius }, ball(-0.2), 0.0)].into();
    let mut most = 0.0_f32;
    for index in 1..=40 {
        environment.obstacles[0].move_to(Placement::at(ball(-0.2 + FRAME * index as f32)), FRAME);
        drape_solver::step(&mut island, &environment).expect("a good step");
        most = most.max(greatest_speed(&island));
    }
    println!("at most {most} m/s");
    assert!(most > 1.0, "the ball pushes: {most} m/s");
    assert!(most < 60.0, "{most} m/s");
}

/// Distance of a point from the surface of one of the shapes above, negative inside.
fn distance(shape: &Shape, p: Vec3) -> f32 {
    match shape {
        Shape::Sphere { radius } => p.length() - radius,
        Shape::Capsule { half_length, radius } => {
            (p - Vec3::Y * p.y.clamp(-half_length, *half_length)).length() - radius
        }
        &Shape::TaperedCapsule { half_length, bottom_radius, top_radius } => {
            to_tapered_capsule(p, half_length, bottom_radius, top_radius)
        }
        Shape::Cuboid { half_extents } => {
            let beyond = p.abs() - *half_extents;
            beyond.max(Vec3::ZERO).length() + beyond.max_element().min(0.0)
        }
        _ => unreachable!("not used here"),
    }
}
