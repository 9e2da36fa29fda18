//! What is shown: the meshes of cloths, interpolated transforms, gizmos; without a window or a GPU.

mod cloth_mesh;
mod cloth_mesh_refusals;
#[path = "../common/mod.rs"]
mod common;
mod detail;
mod driven_mesh;
mod gizmos;
mod interpolation;
mod normals;
mod obstacles;
mod ownership;
mod pose_paint;
mod ropes;
mod schedules;
mod soft_body;
mod torn;
mod vertices;
mod views;
mod writes;

use bevy::asset::AssetPlugin;
use bevy::camera::visibility::VisibilityPlugin;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::{MeshPlugin, VertexAttributeValues};
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::common::*;

/// All that shows a mesh but the renderer.
fn app() -> App {
    app_in(FixedPostUpdate)
}

/// The same, with steps taken in `schedule`.
fn app_in(schedule: impl ScheduleLabel) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin, MeshPlugin, VisibilityPlugin))
        .add_plugins(DrapePlugins::new(schedule));
    app
}

fn particles(app: &App, cloth: Entity) -> Vec<Vec3> {
    app.world().get::<Particles>(cloth).expect("built").positions().collect()
}

fn mesh_of(app: &App, entity: Entity) -> &Mesh {
    let handle = app.world().get::<Mesh3d>(entity).expect("the entity has a mesh");
    app.world().resource::<Assets<Mesh>>().get(handle).expect("the mesh is there")
}

fn vectors(app: &App, entity: Entity, attribute: bevy::mesh::MeshVertexAttribute) -> &Vec<[f32; 3]> {
    match mesh_of(app, entity).attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => values,
        other => panic!("not three numbers a vertex: {other:?}"),
    }
}

/// Vertices in the entity's own coordinates.
fn vertices(app: &App, entity: Entity) -> Vec<Vec3> {
    vectors(app, entity, Mesh::ATTRIBUTE_POSITION).iter().copied().map(Vec3::from_array).collect()
}

/// Vertices in the world, as a renderer puts them there.
fn world_vertices(app: &App, entity: Entity) -> Vec<Vec3> {
    let transform = app.world().get::<GlobalTransform>(entity).expect("placed");
    vertices(app, entity).into_iter().map(|vertex| transform.transform_point(vertex)).collect()
}

fn normals_of(app: &App, entity: Entity) -> Vec<Vec3> {
    vectors(app, entity, Mesh::ATTRIBUTE_NORMAL).iter().copied().map(Vec3::from_array).collect()
}

/// Greatest distance between two points of the same index, in metres.
fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}
