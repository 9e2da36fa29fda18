//! Bodies go to the GPU and come back.

use bevy::camera::primitives::Aabb;
use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::VertexAttributeValues;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy_drape::attach::TeleportCloth;
use bevy_drape::body::Sticks;
use bevy_drape::gpu::drape_gpu::MAX_OBSTACLES;
use bevy_drape::origin::ShiftOrigin;
use bevy_drape::render::{DrivenMesh, PaintChannel};

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
    assert!(!entity.contains::<Particles>() && !entity.contains::<Sticks>());
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
    assert!(is_on_gpu(&app, curtain));
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

/// One obstacle too many once gave the GPU up for ever.
#[test]
fn obstacles_beyond_the_greatest_number_are_left_out_alone() {
    let mut app = app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 2);
    let far = |i: usize| Transform::from_xyz(100.0 + i as f32, 0.0, 0.0);
    app.world_mut().spawn_batch((0..=MAX_OBSTACLES).map(move |i| (Obstacle::sphere(0.1), far(i))));
    run(&mut app, 2);
    assert!(is_on_gpu(&app, cloth));
    assert_eq!(app.world().resource::<GpuBodies>().world().expect("a world").left_out().len(), 1);
}

#[test]
fn a_device_that_is_lost_brings_all_bodies_back() {
    let gpu = Gpu::open().expect("an adapter");
    let mut app = app_without_device();
    app.insert_resource(GpuBodies::on(gpu.clone()));
    let [cloth, disabled] = [spawn(&mut app, swinging()), spawn(&mut app, swinging())];
    run(&mut app, 2);
    for i in 1..=10 {
        app.world_mut().entity_mut(cloth).insert(Transform::from_xyz(0.1 * i as f32, 0.0, 0.0));
        run(&mut app, 1);
    }
    app.world_mut().entity_mut(disabled).insert(Disabled);
    gpu.device().destroy();
    assert!(gpu.wait().is_err());
    run(&mut app, 2);
    assert!(!is_on_gpu(&app, cloth), "a body");
    assert!(!is_on_gpu(&app, disabled), "a disabled body");
    assert!(app.world().resource::<GpuBodies>().failure().is_some());
    // It cannot be read any more: it begins again where its entity is.
    let places = positions(&app, cloth);
    assert!(places[0].distance(Vec3::new(0.5, 0.5, 0.0)) < 1e-3, "its pin is at {}", places[0]);
    assert!(places[80].distance(Vec3::new(1.5, -0.5, 0.0)) < 0.3, "its free corner is at {}", places[80]);
}

/// A renderer that recovers has another device. What is on the old one must neither be read nor stepped.
#[test]
fn another_device_of_the_renderer_takes_the_bodies_over() {
    let [old, new] = [Gpu::open().expect("an adapter"), Gpu::open().expect("an adapter")];
    let mut app = app_without_device();
    let renderer = |gpu: &Gpu| {
        let queue = RenderQueue::new(gpu.queue().clone());
        (RenderDevice::from(gpu.device().clone()), queue)
    };
    let (device, queue) = renderer(&old);
    app.insert_resource(device).insert_resource(queue);
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 30);
    assert!(is_on_gpu(&app, cloth) && positions(&app, cloth)[80].y < -0.6);
    let (device, queue) = renderer(&new);
    app.insert_resource(device).insert_resource(queue);
    old.device().destroy();
    run(&mut app, 3);
    assert!(is_on_gpu(&app, cloth));
    let corner = positions(&app, cloth)[80];
    assert!(corner.distance(Vec3::new(0.5, -0.5, 0.0)) < 0.1, "it begins again, and is at {corner}");
}

#[test]
fn a_component_that_the_gpu_does_not_know_brings_a_body_back() {
    let mut app = app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 20);
    let there = positions(&app, cloth);
    app.world_mut().entity_mut(cloth).insert(Tearable::default());
    assert!(!is_on_gpu(&app, cloth));
    assert_eq!(positions(&app, cloth), there);
    run(&mut app, 2);
    assert!(!is_on_gpu(&app, cloth));
    app.world_mut().entity_mut(cloth).remove::<Tearable>().insert(SolveOnGpu);
    run(&mut app, 2);
    assert!(is_on_gpu(&app, cloth));
    app.world_mut().entity_mut(cloth).insert(TeleportCloth);
    run(&mut app, 2);
    assert!(is_on_gpu(&app, cloth), "for one step only");
}

/// Any change of the fabric once built the body anew, in its first shape.
#[test]
fn a_fabric_of_another_surface_leaves_the_shape() {
    let mut app = app();
    let cloth = spawn(&mut app, (swinging(), Fabric::COTTON));
    run(&mut app, 20);
    let before = positions(&app, cloth)[80];
    app.world_mut().entity_mut(cloth).get_mut::<Fabric>().expect("cotton").friction += 0.1;
    run(&mut app, 1);
    let way = positions(&app, cloth)[80].distance(before);
    assert!(way < 0.2 && before.y < -0.6, "{way} m in a step, from {before}");
    assert!(is_on_gpu(&app, cloth));
}

/// One that was despawned while disabled was solved for ever.
#[test]
fn disabled_bodies_leave_the_gpu_with_their_entities() {
    let mut app = app();
    let cloth = spawn(&mut app, swinging());
    run(&mut app, 2);
    app.world_mut().entity_mut(cloth).insert(Disabled);
    run(&mut app, 2);
    app.world_mut().entity_mut(cloth).despawn();
    run(&mut app, 2);
    assert!(app.world().resource::<GpuBodies>().world().expect("a world").is_empty());
}

/// A cone, whose vertices at the rim are three for each particle.
fn cone(app: &mut App) -> Handle<Mesh> {
    let mesh = Cone::new(0.5, 1.0).mesh().resolution(12);
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

/// A cloth made of a cone, which hangs by a place at its rim.
fn cone_cloth(app: &mut App) -> Entity {
    let mesh = cone(app);
    spawn(app, (Mesh3d(mesh), ClothMesh::default().with_pins([1])))
}

#[test]
fn cloth_from_a_mesh_goes_and_comes_back() {
    let mut app = app();
    let cloth = cone_cloth(&mut app);
    run(&mut app, 2);
    let start = positions(&app, cloth);
    run(&mut app, 28);
    // A cloth that moves while it is on the GPU was once built anew.
    app.world_mut().entity_mut(cloth).insert(Transform::from_xyz(0.01, 0.0, 0.0));
    run(&mut app, 1);
    assert!(is_on_gpu(&app, cloth));
    let there = positions(&app, cloth);
    let way = start.iter().zip(&there).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(way > 0.1, "it swings from a place at its rim: {way} m");
    app.world_mut().entity_mut(cloth).remove::<SolveOnGpu>();
    assert_eq!(positions(&app, cloth), there);
    frame(&mut app, 1.0);
    frame(&mut app, 0.25);
    let lowest = |places: &[Vec3]| places.iter().map(|place| place.y).fold(9.0, f32::min);
    let apart = lowest(&shown(&app, cloth)) - lowest(&there);
    assert!(apart.abs() < 0.1, "it is drawn {apart} m above where it is");
    assert!(app.world().entity(cloth).get::<Aabb>().expect("bounds").half_extents.y > 0.3);

    app.world_mut().entity_mut(cloth).insert(SolveOnGpu);
    run(&mut app, 2);
    let other = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cone::new(0.5, 1.0).mesh().resolution(6));
    app.world_mut().entity_mut(cloth).insert(Mesh3d(other));
    run(&mut app, 3);
    assert!(is_on_gpu(&app, cloth) && positions(&app, cloth).len() < there.len(), "it is built anew");
    app.world_mut().entity_mut(cloth).remove::<ClothMesh>();
    run(&mut app, 2);
    assert!(!is_on_gpu(&app, cloth));
    assert!(app.world().resource::<GpuBodies>().world().expect("a world").is_empty());
}

#[test]
fn a_rope_goes_and_comes_back_with_its_tube() {
    let mut app = app();
    let rope = spawn(&mut app, (Rope::new(Vec3::ZERO, Vec3::X, 20), RopeMesh::new(1.0)));
    run(&mut app, 30);
    assert!(is_on_gpu(&app, rope));
    let there = positions(&app, rope);
    let lowest = |places: &[Vec3]| places.iter().map(|place| place.y).fold(9.0, f32::min);
    assert!(lowest(&there) < -0.5, "it swings down: {}", lowest(&there));
    let bounds = app.world().entity(rope).get::<Aabb>().expect("bounds");
    assert!(bounds.min().y < lowest(&there) - 1.0, "its bounds hold the tube");
    app.world_mut().entity_mut(rope).remove::<SolveOnGpu>();
    assert_eq!(positions(&app, rope), there);
    frame(&mut app, 1.0);
    frame(&mut app, 0.25);
    let last_ring = &shown(&app, rope)[19 * 9..][..8];
    let way = (last_ring.iter().sum::<Vec3>() / 8.0).distance(there[19]);
    assert!(way < 0.2, "its end is drawn {way} m from where it was");
}

/// A mesh that follows a body would stand still.
#[test]
fn a_body_that_a_mesh_follows_stays_on_the_processor() {
    let mut app = app();
    let mesh = cone(&mut app);
    let driver = spawn(&mut app, swinging());
    run(&mut app, 2);
    assert!(is_on_gpu(&app, driver));
    app.world_mut().spawn((Mesh3d(mesh), DrivenMesh { driver }));
    run(&mut app, 3);
    assert!(!is_on_gpu(&app, driver));
}

/// The old body once came back in place of the new one.
#[test]
fn a_cloth_that_gains_limits_is_built_anew_on_the_processor() {
    let mut app = app();
    let cloth = cone_cloth(&mut app);
    run(&mut app, 30);
    assert!(is_on_gpu(&app, cloth));
    let mut finer = Cone::new(0.5, 1.0).mesh().resolution(20).build();
    let blue = vec![[0.0_f32, 0.0, 0.1, 1.0]; finer.count_vertices()];
    finer.insert_attribute(Mesh::ATTRIBUTE_COLOR, blue);
    let finer = app.world_mut().resource_mut::<Assets<Mesh>>().add(finer);
    let paint = ClothPaint { pins: None, max_distance: Some(PaintChannel::Blue), ..default() };
    app.world_mut().entity_mut(cloth).insert((Mesh3d(finer), ClothMesh { paint, ..default() }));
    run(&mut app, 3);
    assert!(!is_on_gpu(&app, cloth));
    assert_eq!(positions(&app, cloth).len(), 21);
    assert!(app.world().resource::<GpuBodies>().world().expect("a world").is_empty());
    let start = positions(&app, cloth);
    run(&mut app, 60);
    let way = start.iter().zip(positions(&app, cloth)).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    assert!(way < 0.25, "limits hold it: {way} m");
}

/// In other coordinates a body on the GPU goes on as it would have.
#[test]
fn a_shift_of_the_origin_changes_coordinates_only() {
    let (mut straight, mut shifted) = (app(), app());
    let [one, other] = [&mut straight, &mut shifted].map(|app| {
        app.world_mut().spawn(Obstacle::ground());
        let sheet = spawn(app, (swinging(), Transform::from_xyz(0.0, 1.2, 0.0)));
        run(app, 10);
        sheet
    });
    let origin = Vec3::new(64.0, -32.0, 128.0);
    ShiftOrigin(origin).apply(shifted.world_mut());
    for _ in 0..3 {
        let places = positions(&straight, one).into_iter().zip(positions(&shifted, other));
        let off = places.map(|(a, b)| a.distance(b + origin)).fold(0.0, f32::max);
        assert!(off < 1e-3, "{off} m apart");
        run(&mut straight, 10);
        run(&mut shifted, 10);
    }
    assert!(is_on_gpu(&shifted, other));
}
