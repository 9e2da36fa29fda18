//! Meshes and materials of the bodies and obstacles of a running scene, as its file gives them.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::scene;

use crate::scripted::shape_meshes::meshes_of;
use crate::view::lighting::LightingPlugin;
use crate::view::shape_meshes::solid;
use crate::view::shared_materials::{EARTH, SharedMaterials, SharedMaterialsPlugin};
use crate::view::tubes::TubesPlugin;

/// Colour of obstacles that have no material, but for the ground.
const SOLID: Color = Color::srgb(0.45, 0.52, 0.58);

/// Adds meshes and materials to the bodies and obstacles of a scene.
pub struct SceneMaterialsPlugin;

impl Plugin for SceneMaterialsPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((LightingPlugin, SharedMaterialsPlugin, TubesPlugin))
            .add_systems(Update, (add_cloth_materials, add_obstacle_meshes));
    }
}

/// The material that the scene gives to the body or obstacle of this name.
fn material(play: &ScenePlay, name: &str) -> Option<scene::Material> {
    let script = play.script();
    let of_body = script.bodies.get(name).and_then(scene::Body::material);
    let of_obstacle = script.obstacles.get(name).and_then(|obstacle| obstacle.material.as_deref());
    script.materials.get(of_body.or(of_obstacle)?).cloned()
}

fn colour(material: &scene::Material) -> Color {
    let (red, green, blue) = material.colour;
    Color::srgb(red.get(), green.get(), blue.get())
}

fn add_cloth_materials(
    cloths: Query<
        (Entity, &Name),
        (Or<(With<Cloth>, With<ClothMesh>, With<SoftBodyMesh>)>, Without<MeshMaterial3d<StandardMaterial>>),
    >,
    play: Option<Res<ScenePlay>>,
    shared: Res<SharedMaterials>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, name) in &cloths {
        let own = play.as_deref().and_then(|play| material(play, name));
        let fabric = own.map(|own| {
            materials.add(StandardMaterial {
                base_color: colour(&own),
                perceptual_roughness: own.roughness.get(),
                metallic: own.metallic.get(),
                double_sided: true,
                cull_mode: None,
                ..default()
            })
        });
        commands.entity(entity).insert(MeshMaterial3d(fabric.unwrap_or(shared.fabric.clone())));
    }
}

/// Marks an obstacle that has its meshes.
#[derive(Component)]
struct HasMeshes;

fn add_obstacle_meshes(
    obstacles: Query<(Entity, &Obstacle, &Name), Without<HasMeshes>>,
    play: Option<Res<ScenePlay>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    let Some(play) = play else { return };
    for (entity, obstacle, name) in &obstacles {
        let mut parent = commands.entity(entity);
        parent.insert((HasMeshes, Interpolated, Visibility::default()));
        let told = play.script().obstacles.get(name.as_str());
        // Sensors are not drawn.
        let Some(told) = told.filter(|_| !obstacle.is_sensor) else { continue };
        let usual = if matches!(told.shape, scene::Shape::Ground) { EARTH } else { SOLID };
        let own = material(&play, name);
        let material = materials.add(solid(own.as_ref().map_or(usual, colour)));
        for (mesh, place) in meshes_of(&told.shape) {
            parent.with_child((Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()), place));
        }
    }
}
