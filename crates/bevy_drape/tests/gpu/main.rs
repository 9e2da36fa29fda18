//! Bodies on the GPU, with a renderer and without one. Needs a graphics adapter: `.ci/gpu`.

mod drawn;
mod moves;
mod stepped;

use std::sync::OnceLock;
use std::time::Duration;

use bevy::asset::AssetPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::gpu::drape_gpu::Gpu;
use bevy_drape::gpu::{GpuBodies, GpuBody, SolveOnGpu};
use bevy_drape::prelude::*;

/// Bevy's default fixed step, 1/64 s: exact in nanoseconds and in binary.
const TIMESTEP: Duration = Duration::from_micros(15_625);

/// An app without a renderer, whose bodies are solved on a device of its own.
fn app() -> App {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    let gpu = GPU.get_or_init(|| Gpu::open().expect("an adapter"));
    let mut app = app_without_device();
    app.insert_resource(GpuBodies::on(gpu.clone()));
    app
}

fn app_without_device() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin, MeshPlugin))
        .add_plugins(DrapePlugins::default());
    start(&mut app);
    app
}

/// Makes the app ready; its first update is one of no time.
fn start(app: &mut App) {
    app.finish();
    app.cleanup();
    app.update();
}

/// One frame, as long as `steps` fixed steps.
fn frame(app: &mut App, steps: f64) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TIMESTEP.mul_f64(steps)));
    app.update();
}

/// So many frames of one step each.
fn run(app: &mut App, frames: usize) {
    (0..frames).for_each(|_| frame(app, 1.0));
}

/// Positions of a body, wherever it is.
fn positions(app: &App, body: Entity) -> Vec<Vec3> {
    let entity = app.world().entity(body);
    match (entity.get::<Particles>(), entity.get::<GpuBody>()) {
        (Some(particles), None) => particles.positions().collect(),
        (None, Some(body)) => {
            let world = app.world().resource::<GpuBodies>().world().expect("a world");
            world.read_positions(body.id()).expect("positions")
        }
        _ => panic!("it is in both places, or in none"),
    }
}

fn is_on_gpu(app: &App, body: Entity) -> bool {
    app.world().entity(body).contains::<GpuBody>()
}

/// A sheet of 1 m x 1 m in 9 x 9 particles that hangs from its top left corner, and swings.
fn swinging() -> Cloth {
    Cloth::new(1.0, 1.0).with_particles(9, 9).with_pins(ClothPins::Indices([0].into()))
}

fn spawn(app: &mut App, bundle: impl Bundle) -> Entity {
    app.world_mut().spawn((bundle, SolveOnGpu)).id()
}
