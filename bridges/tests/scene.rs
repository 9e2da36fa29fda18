//! Apps and sheets.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

use crate::engine::{DYNAMIC, STATIC, add_bridge, add_engine, cuboid, half_space, mass};

/// Bevy's default fixed step.
pub const TIMESTEP: Duration = Duration::from_micros(15_625);

/// Gravity of both engines in m/s^2.
pub const G: f32 = 9.81;

/// The engine and cloth.
pub fn app() -> App {
    let mut app = engine();
    app.add_plugins(DrapePlugins::default());
    add_bridge(&mut app);
    started(app)
}

/// The engine alone.
pub fn app_without_cloth() -> App {
    started(engine())
}

/// The environment variable with the number of threads in each of Bevy's pools; without it there are as many as Bevy likes.
pub const THREADS: &str = "BRIDGE_TEST_THREADS";

fn engine() -> App {
    let mut app = App::new();
    let threads = std::env::var(THREADS).ok().and_then(|threads| threads.parse().ok());
    let task_pool_options = threads.map_or_else(TaskPoolOptions::default, TaskPoolOptions::with_num_threads);
    app.add_plugins((MinimalPlugins.set(TaskPoolPlugin { task_pool_options }), TransformPlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(TIMESTEP));
    add_engine(&mut app);
    app
}

fn started(mut app: App) -> App {
    app.finish();
    app.cleanup();
    app.update();
    app
}

pub fn run(app: &mut App, seconds: f32) {
    for _ in 0..(seconds / TIMESTEP.as_secs_f32()).round() as usize {
        app.update();
    }
}

/// A square sheet that lies in the air `height` metres above the ground.
pub fn sheet(app: &mut App, height: f32) -> Entity {
    let lying = Transform::from_xyz(0.0, height, 0.0)
        .with_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let cloth = Cloth::new(0.8, 0.8).with_particles(17, 17).with_pins(ClothPins::None);
    app.world_mut().spawn((cloth, lying)).id()
}

/// A sheet of 1 m that hangs flat in the air, pinned along its border.
pub fn net(app: &mut App, height: f32) -> Entity {
    let lying = Transform::from_xyz(0.0, height, 0.0)
        .with_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let is_border = |i: &u32| [0, 16].contains(&(i % 17)) || [0, 16].contains(&(i / 17));
    let border = ClothPins::Indices((0..17 * 17).filter(is_border).collect());
    let cloth = Cloth::new(1.0, 1.0).with_particles(17, 17).with_pins(border);
    app.world_mut().spawn((cloth, lying)).id()
}

/// A crate of so many kilograms and sides of `side` metres.
pub fn box_of(side: f32, kilograms: f32) -> impl Bundle {
    (DYNAMIC, cuboid(Vec3::splat(side)), mass(kilograms, kilograms * side * side / 6.0))
}

pub fn heights(app: &App, body: Entity) -> impl Iterator<Item = f32> {
    let particles = app.world().get::<Particles>(body).expect("the body is built");
    particles.positions().map(|p| p.y).collect::<Vec<_>>().into_iter()
}

pub fn least(app: &App, body: Entity) -> f32 {
    heights(app, body).fold(f32::INFINITY, f32::min)
}

pub fn greatest(app: &App, body: Entity) -> f32 {
    heights(app, body).fold(f32::NEG_INFINITY, f32::max)
}

pub fn ground(app: &mut App) {
    app.world_mut().spawn((STATIC, half_space()));
}

pub fn place(app: &App, body: Entity) -> Vec3 {
    app.world().get::<Transform>(body).expect("it is there").translation
}

/// Half the side of a crate in metres.
pub const HALF: f32 = 0.15;

/// A crate of so many kilograms.
pub fn spawn_crate(app: &mut App, kilograms: f32, at: Vec3) -> Entity {
    app.world_mut().spawn((box_of(2.0 * HALF, kilograms), Transform::from_translation(at))).id()
}

/// A rope from a hook at `from` to a place on a crate.
pub fn hang(app: &mut App, from: Vec3, crate_: Entity, to: Vec3) -> Entity {
    let hook = app.world_mut().spawn(Transform::from_translation(from)).id();
    let tied = Attachment::first(hook).and(Tie::last(crate_));
    app.world_mut().spawn((Rope::new(from, to, 33), tied)).id()
}
