//! Bodies go to the GPU and come back.

use bevy::mesh::VertexAttributeValues;
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::gpu::drape_gpu::MAX_OBSTACLES;

use crate::*;

/// Vertices of a body as the processor has them.
fn shown(app: &App, body: Entity) -> Vec<Vec3> {
    let mesh = app.world().entity(body).get::<Mesh3d>().expect("a mesh");
    let mesh = app.world().resource::<Assets<Mesh>>().get(mesh).expect("it is there");
    match mesh.attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(places)) => places.iter().map(|&place| place.into()).collect(),
        _ => panic!("it has no positions"),
    }
}

#[test]
fn a_body_on_the_gpu_leaves_nothing_behind_that_is_out_of_date() {
    let mut app = app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 2);
    let entity = app.world().entity(cloth);
    assert!(entity.contains::<GpuBody>());
    assert!(
        !entity.contains::<Particles>() && !entity.contains::<Sticks>() && !entity.contains::<Activity>()
    );
}

#[test]
fn released_bodies_go_on_from_where_they_are() {
    let mut app = app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 20);
    let there = positions(&app, cloth);
    app.world_mut().entity_mut(cloth).remove::<SolveOnGpu>();
    assert!(!is_on_gpu(&app, cloth));
    assert_eq!(positions(&app, cloth), there);
    assert_eq!(app.world().resource::<GpuBodies>().world().expect("a world").len(), 0);
    frame(&mut app, 1.0);
    frame(&mut app, 0.25);
    let shown = shown(&app, cloth)[80];
    let way = shown.distance(there[80]);
    assert!(way < 0.2, "it is drawn {way} m from where it was");
    run(&mut app, 20);
    let lowest = |places: &[Vec3]| places.iter().map(|place| place.y).fold(9.0, f32::min);
    assert!(lowest(&positions(&app, cloth)) < lowest(&there), "it falls on");

    app.world_mut().entity_mut(cloth).insert(SolveOnGpu);
    let here = positions(&app, cloth);
    run(&mut app, 1);
    assert!(is_on_gpu(&app, cloth));
    let way = positions(&app, cloth)[80].distance(here[80]);
    assert!((1e-4..0.2).contains(&way), "and goes there again, in motion: {way} m in a step");
}

#[test]
fn despawned_and_rebuilt_bodies_leave_the_gpu() {
    let mut app = app();
    let [one, two] = [spawn(&mut app, swinging()), spawn(&mut app, swinging())];
    let count = |app: &App| app.world().resource::<GpuBodies>().world().expect("a world").len();
    run(&mut app, 2);
    assert_eq!(count(&app), 2);
    app.world_mut().entity_mut(one).insert(Cloth::new(1.0, 1.0).with_particles(5, 5));
    run(&mut app, 2);
    assert_eq!((count(&app), positions(&app, one).len()), (2, 25), "it is built anew");
    app.world_mut().entity_mut(one).despawn();
    app.world_mut().entity_mut(two).remove::<Cloth>();
    run(&mut app, 2);
    assert_eq!(count(&app), 0);
    assert!(!is_on_gpu(&app, two));
}

/// An entity that moves without a body is built anew, in case its place was refused. One on the GPU has a body.
#[test]
fn a_cloth_that_moves_is_not_built_anew() {
    let mut app = app();
    let curtain = spawn(&mut app, swinging());
    run(&mut app, 30);
    let before = positions(&app, curtain)[80];
    app.world_mut().entity_mut(curtain).insert(Transform::from_xyz(0.0, 0.01, 0.0));
    run(&mut app, 1);
    let after = positions(&app, curtain)[80];
    assert!(before.distance(after) < 0.2 && after.y < -0.6, "from {before} to {after}");
}

#[test]
fn the_processor_keeps_what_the_gpu_does_not_solve() {
    let mut app = app();
    let torn = spawn(&mut app, (swinging(), Tearable::default()));
    let folded = spawn(&mut app, (swinging(), SolverSettings { self_contact: SelfContact::On, ..default() }));
    let other = spawn(&mut app, swinging());
    run(&mut app, 4);
    assert!(!is_on_gpu(&app, torn) && !is_on_gpu(&app, folded) && is_on_gpu(&app, other));
    for body in [torn, folded] {
        assert!(positions(&app, body)[80].y < -0.501, "it falls");
    }
}

#[test]
fn without_a_device_the_processor_solves_all() {
    let mut app = app_without_device();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 4);
    assert!(!is_on_gpu(&app, cloth));
    assert!(positions(&app, cloth)[80].y < -0.501, "it falls");
    assert!(app.world().resource::<GpuBodies>().failure().is_some());
}

#[test]
fn a_step_that_fails_brings_all_bodies_back() {
    let mut app = app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 20);
    let there = positions(&app, cloth)[80];
    let far = |i: usize| Transform::from_xyz(100.0 + i as f32, 0.0, 0.0);
    app.world_mut().spawn_batch((0..=MAX_OBSTACLES).map(move |i| (Obstacle::sphere(0.1), far(i))));
    run(&mut app, 2);
    assert!(!is_on_gpu(&app, cloth));
    let way = positions(&app, cloth)[80].distance(there);
    assert!((1e-4..0.2).contains(&way), "it goes on here, by {way} m");
    let failure = app.world().resource::<GpuBodies>().failure().expect("a failure");
    assert!(failure.contains("MAX_OBSTACLES"), "{failure}");
}
