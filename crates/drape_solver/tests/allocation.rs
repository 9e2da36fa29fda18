//! A step allocates nothing once warm.

use std::alloc::System;

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{
    Ball, BallMaterial, ClothBuilder, Edge, Environment, Island, Obstacle, Placement, SelfContact, Shape,
    SolverSettings, StructuralSolve, Wind, step,
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations in the second half of a shot at a curtain, over ground, in a sensor and beside a turning capsule.
#[test]
fn a_warm_step_allocates_nothing() {
    for structural in [StructuralSolve::Sweeps, StructuralSolve::Lines] {
        allocate_nothing(SolverSettings { structural, ..SolverSettings::default() });
    }
    // Not a test of its own: the count is that of the whole program.
    fold_allocating_nothing();
}

/// A cloth that has folded onto itself.
fn fold_allocating_nothing() {
    let settings =
        SolverSettings { thickness: 0.02, self_contact: SelfContact::Particles, ..SolverSettings::default() };
    let cloth = ClothBuilder::new(0.9, 0.9, 24, 24)
        .placed(Vec3::new(0.0, 1.0, 0.0), Vec3::X, Vec3::new(0.0, -0.995, 0.0998))
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(cloth);
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..Environment::default() };
    let mut steps = |count: u32| {
        (0..count).for_each(|_| step(&mut island, &environment).expect("a good step"));
    };
    steps(240);
    let region = Region::new(ALLOCATOR);
    steps(60);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
    assert!(island.self_contact_pairs() > 0, "it must have come near itself");
}

fn allocate_nothing(settings: SolverSettings) {
    let dt = 1.0 / 60.0;
    let curtain = ClothBuilder::new(1.5, 1.5, 24, 24)
        .placed(Vec3::new(-0.75, 1.2, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(curtain);
    let shot = |z: f32| Ball::new(BallMaterial::default(), Vec3::new(0.1, 0.8, z), Vec3::NEG_Z * z * 8.0);
    island.balls.push(shot(2.0).expect("valid"));
    island.balls.push(shot(2.5).expect("valid"));
    let capsule = Shape::Capsule { half_length: 0.5, radius: 0.2 };
    let capsule = Obstacle::new(capsule, Placement::at(Vec3::new(0.0, 0.3, -0.3)), 0.5).expect("valid");
    let sensor = Shape::Parry(SharedShape::cone(1.0, 1.0));
    let sensor = Obstacle::new(sensor, Placement::at(Vec3::Y), 0.5).expect("valid").as_sensor();
    island.bodies[0].reports_contacts = true;
    island.balls[0].set_reports_contacts(true);
    let mut environment = Environment {
        dt,
        wind: Wind::new(Vec3::Z),
        obstacles: vec![Obstacle::ground(), capsule, sensor].into(),
        ..Environment::default()
    };
    let (mut touches, mut contacts) = (0, 0);
    let mut steps = |count: usize| {
        for index in 0..count {
            let rotation = Quat::from_rotation_z(0.02 * index as f32);
            let placement = environment.obstacles[1].placement();
            environment.obstacles[1].move_to(Placement { rotation, ..placement }, dt);
            island.bodies[0].particles.add_force(300, Vec3::X);
            island.bodies[0].particles.set_pin_target(0, Vec3::new(-0.75, 1.2, 0.001 * (index % 7) as f32));
            step(&mut island, &environment).expect("a good step");
            touches += island.touches.len();
            contacts += island.contacts.len();
        }
    };
    // The first seconds see the hit: every list has then been as long as it gets.
    steps(240);
    let region = Region::new(ALLOCATOR);
    steps(120);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
    assert!(touches > 10, "the balls must have hit something");
    assert!(contacts > 400, "the sensor must have told of the curtain: {contacts}");
}
