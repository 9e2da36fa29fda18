//! What the bodies and obstacles of a running scene look like: the materials that the scene gives them.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use bevy_drape_script::recording::Form;
use bevy_drape_script::scene;
use drape_solver::StickKind;

use crate::scene_forms::{material_of, mesh_of};
use crate::visuals::{EARTH, OutdoorsPlugin, Wardrobe};

/// Colour of the lines of ropes and rigs.
const LINE: Color = Color::srgb(0.25, 0.16, 0.10);

/// Dresses whatever a scene spawns.
pub struct DressPlugin;

impl Plugin for DressPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(OutdoorsPlugin).add_systems(Update, (dress_cloths, dress_obstacles, draw_lines));
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
    cloths: Query<(Entity, &Name), (With<Cloth>, Without<MeshMaterial3d<StandardMaterial>>)>,
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
    obstacles: Query<(Entity, &Obstacle, Option<&Name>), Without<Dressed>>,
    play: Option<Res<ScenePlay>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, obstacle, name) in &obstacles {
        let form = Form::of(&obstacle.shape);
        let own = play.as_deref().zip(name).and_then(|(play, name)| material(play, name));
        let mut dressed = commands.entity(entity);
        dressed.insert((Dressed, Interpolated, Visibility::default()));
        // What only senses is air.
        if let Some((mesh, transform)) = mesh_of(form).filter(|_| !obstacle.is_sensor) {
            let material = material_of(form, own.as_ref().map_or(EARTH, colour));
            dressed.with_child((
                Mesh3d(meshes.add(mesh)),
                MeshMaterial3d(materials.add(material)),
                transform,
            ));
        }
    }
}

/// Ropes and rigs have no surface: their structural sticks are drawn.
fn draw_lines(bodies: Query<(&Particles, &Sticks)>, mut gizmos: Gizmos) {
    for (particles, sticks) in &bodies {
        if !sticks.faces().is_empty() {
            continue;
        }
        let structural = sticks.batches().iter().filter(|batch| batch.material.kind == StickKind::Structural);
        for stick in structural.flat_map(drape_solver::StickBatch::range) {
            let [a, b] = sticks.stick(stick).map(|end| particles.position(end as usize));
            gizmos.line(a, b, LINE);
        }
    }
}
