//! Bodies on the GPU, with a renderer and without one. Needs a graphics adapter: `.ci/gpu`.

mod bounds;
#[path = "../common/mod.rs"]
mod common;
mod detail;
mod drawn;
mod moves;
mod rest;
mod stepped;

use std::sync::OnceLock;

use bevy::asset::AssetPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy_drape::body::{DefaultSolverSettings, StructuralSolve};
use bevy_drape::gpu::drape_gpu::Gpu;
use bevy_drape::gpu::{GpuBodies, GpuBody, SolveOnGpu};
use bevy_drape::prelude::*;

use crate::common::*;

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
    app.insert_resource(DefaultSolverSettings(swept()));
    start(&mut app);
    app
}

/// The default settings, but swept, as on the GPU: tests compare it with the processor.
fn swept() -> SolverSettings {
    SolverSettings { structural: StructuralSolve::Sweeps, ..default() }
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

fn spawn(app: &mut App, bundle: impl Bundle) -> Entity {
    app.world_mut().spawn((bundle, SolveOnGpu)).id()
}
