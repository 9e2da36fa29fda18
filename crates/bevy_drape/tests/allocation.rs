//! A step of the plugin allocates nothing once warm.

use std::alloc::System;
use std::time::Duration;

use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use bevy::time::TimeUpdateStrategy;
use bevy_drape::clock::DrapeClock;
use bevy_drape::contact::DrapeContactCounts;
use bevy_drape::prelude::*;
use bevy_drape::sleep::{ActivityCounts, SceneManager};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Runs nothing but the plugin's steps.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Steps;

#[test]
fn a_warm_step_allocates_nothing() {
    // Work that is given to other threads is boxed by Bevy.
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(1).build());
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, DrapePlugins::new(Steps)))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(1.0 / 60.0)))
        .insert_resource(Wind { velocity: Vec3::Z, ..default() });
    // So are the systems of a schedule on Bevy's executor for several threads.
    app.edit_schedule(Steps, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
    app.update();
    app.update();
    let world = app.world_mut();
    world.spawn((Obstacle::ground(), ContactEvents));
    world.spawn((
        Obstacle::cuboid(1.0, 1.0, 1.0).as_sensor(),
        Transform::from_xyz(0.0, 1.0, 0.0),
        ContactEvents,
    ));
    let door = world.spawn((Obstacle::cuboid(0.5, 0.5, 0.1), Transform::from_xyz(5.0, 1.0, 0.0))).id();
    let curtain = world.spawn((Cloth::new(1.0, 1.0), Transform::from_xyz(0.0, 1.5, 0.0))).id();
    for i in 0..3 {
        let ball = Projectile { velocity: Vec3::new(0.1, 1.0, 8.0), ..default() };
        world.spawn((ball, Transform::from_xyz(0.0, 1.3, -2.0 - i as f32)));
    }
    // Bodies at rest beside them.
    world.insert_resource(SceneManager { sleep_time: 0.2, ..default() });
    for i in 0..20 {
        world.spawn((Rope::default(), Transform::from_xyz(10.0 + i as f32, 3.0, 0.0)));
    }
    let steps = |world: &mut World, count: usize| {
        for index in 0..count {
            let mut door = world.get_mut::<Transform>(door).expect("a door");
            door.rotation = Quat::from_rotation_y(0.02 * index as f32);
            if let Some(mut particles) = world.get_mut::<Particles>(curtain) {
                particles.add_force(200, Vec3::X * 0.1);
            }
            world.run_schedule(Steps);
        }
    };
    // Until the balls have rolled into a heap, whose lists are the longest.
    steps(world, 700);
    let region = Region::new(ALLOCATOR);
    steps(world, 120);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
    assert_eq!(world.resource::<DrapeClock>().steps(), 820);
    let contacts = world.resource::<DrapeContactCounts>();
    assert!(contacts.touching >= 4, "the balls on the ground and the curtain in the sensor: {contacts:?}");
    let counts = world.resource::<ActivityCounts>();
    assert!(counts.active >= 1 && counts.resting >= 20, "{counts:?}");
}
