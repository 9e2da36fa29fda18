//! Clothes on skinned characters: pins, limits, backstops and drives that follow joints, motion that is inherited or not, teleports.

mod asset;
mod backstops;
mod body;
#[cfg(feature = "gltf")]
#[path = "../../examples/cape_gltf.rs"]
#[expect(dead_code, reason = "the example's own `main`")]
mod cape_gltf;
#[cfg(feature = "gltf")]
mod gltf;
mod measure;
mod outfit;
mod skinned;
mod walk;

use std::time::Duration;

use bevy::mesh::{MeshPlugin, VertexAttributeValues};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;
use drape_examples::view::asset_files::asset_plugin;

/// All but the renderer, at sixty steps a second.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, asset_plugin(), TransformPlugin, MeshPlugin))
        .add_plugins(DrapePlugins::default())
        .insert_resource(Time::<Fixed>::from_seconds(1.0 / 60.0));
    app
}

/// One step in each update from now on.
fn one_step_a_frame(app: &mut App) {
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.update();
}

/// Frames of this length from now on.
fn frames(app: &mut App, seconds: f64) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(seconds)));
}

fn particles(app: &App, body: Entity) -> &Particles {
    app.world().get::<Particles>(body).expect("built")
}

fn global(app: &App, entity: Entity) -> GlobalTransform {
    *app.world().get::<GlobalTransform>(entity).expect("placed")
}

/// The mesh that is drawn.
fn shown(app: &App, cape: Entity) -> &Mesh {
    let mesh = app.world().get::<Mesh3d>(cape).expect("a mesh");
    app.world().resource::<Assets<Mesh>>().get(mesh).expect("the mesh is there")
}

/// Vertices in the entity's own coordinates.
fn vertices(app: &App, cape: Entity) -> Vec<Vec3> {
    match shown(app, cape).attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(places)) => {
            places.iter().copied().map(Vec3::from_array).collect()
        }
        _ => panic!("no positions"),
    }
}
