//! A step with meshes, and a picture of it, allocate nothing once warm.

use std::alloc::System;
use std::time::Duration;

use bevy::asset::AssetPlugin;
use bevy::camera::CameraProjection;
use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;
use bevy_drape::render::DrivenMesh;
use bevy_drape::sleep::{ActivityCounts, SceneManager};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Runs nothing but the plugin's steps.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Steps;

#[test]
fn a_warm_step_and_its_picture_allocate_nothing() {
    // Work that is given to other threads is boxed by Bevy, and so are the systems of its executor for several.
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(1).build());
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default()))
        .init_asset::<Mesh>()
        .add_plugins(DrapePlugins::new(Steps))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(1.0 / 60.0)));
    app.edit_schedule(Steps, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
    app.edit_schedule(PostUpdate, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
    app.update();
    app.update();
    let world = app.world_mut();
    world.spawn(Obstacle::ground());
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let cube = meshes.add(Cuboid::from_length(0.5));
    let ball = meshes.add(Sphere::new(0.3).mesh().uv(24, 16));
    let sheet = meshes.add(Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(15));
    let jelly = world.spawn((Mesh3d(cube), SoftBodyMesh::default(), Transform::from_xyz(0.0, 0.5, 0.0))).id();
    let detail = (Mesh3d(ball), DrivenMesh { driver: jelly }, Transform::from_xyz(0.0, 0.5, 0.0));
    world.spawn(detail);
    let curtain = world.spawn(Cloth::new(1.0, 1.0).with_pins(ClothPins::Indices(vec![0]))).id();
    world.spawn((Mesh3d(sheet), DrivenMesh { driver: curtain }));
    world.spawn((Rope::default(), RopeMesh::default(), Transform::from_xyz(3.0, 2.0, 0.0)));
    let view = PerspectiveProjection::default().compute_frustum(&Transform::from_xyz(0.0, 1.0, 9.0).into());
    world.spawn((Camera::default(), view));
    world.insert_resource(SceneManager { sleeping: false, ..default() });
    let steps = |world: &mut World, count: usize| {
        for _ in 0..count {
            world.run_schedule(Steps);
            world.run_schedule(PostUpdate);
            // As Bevy does in `First`, which does not run here.
            world.resource_mut::<Messages<AssetEvent<Mesh>>>().clear();
        }
    };
    steps(world, 300);
    let region = Region::new(ALLOCATOR);
    steps(world, 60);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
    assert_eq!(world.resource::<ActivityCounts>().active, 3);
    assert!(world.resource::<Refusals>().is_empty());
}
