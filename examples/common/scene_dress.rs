//! What the bodies and obstacles of a running scene look like: the materials that the scene gives them.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::scene;

use crate::cords::CordsPlugin;
use crate::scene_forms::{meshes_of, solid};
use crate::visuals::{EARTH, OutdoorsPlugin, Wardrobe};

/// Colour of obstacles that have no material, but for the ground.
const SOLID: Color = Color::srgb(0.45, 0.52, 0.58);

/// Dresses whatever a scene spawns.
pub struct DressPlugin;

impl Plugin for DressPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((OutdoorsPlugin, CordsPlugin)).add_systems(Update, (dress_cloths, dress_obstacles));
    }
}

/// The material that the scene gives to what has this name.
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

fn dress_cloths(
    cloths: Query<
        (Entity, &Name),
        (Or<(With<Cloth>, With<ClothMesh>, With<SoftBody>)>, Without<MeshMaterial3d<StandardMaterial>>),
    >,
    play: Option<Res<ScenePlay>>,
    wardrobe: Res<Wardrobe>,
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
        commands.entity(entity).insert(MeshMaterial3d(fabric.unwrap_or(wardrobe.fabric.clone())));
    }
}

/// Marks an obstacle that has been given its looks.
#[derive(Component)]
struct Dressed;

fn dress_obstacles(
    obstacles: Query<(Entity, &Obstacle, &Name), Without<Dressed>>,
    play: Option<Res<ScenePlay>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    let Some(play) = play else { return };
    for (entity, obstacle, name) in &obstacles {
        let mut dressed = commands.entity(entity);
        dressed.insert((Dressed, Interpolated, Visibility::default()));
        let told = play.script().obstacles.get(name.as_str());
        // What only senses is air.
        let Some(told) = told.filter(|_| !obstacle.is_sensor) else { continue };
        let usual = if matches!(told.shape, scene::Shape::Ground) { EARTH } else { SOLID };
        let own = material(&play, name);
        let material = materials.add(solid(own.as_ref().map_or(usual, colour)));
        for (mesh, place) in meshes_of(&told.shape) {
            dressed.with_child((Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()), place));
        }
    }
}
