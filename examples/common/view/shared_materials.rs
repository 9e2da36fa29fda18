//! Materials that bodies of the same kind share, and the meshes of balls.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::view::cannon_model::{aim_model, build_cannon};
use crate::view::paint::Paint;
use crate::view::textures;

/// Colour of the ground.
pub const EARTH: Color = Color::srgb(0.50, 0.47, 0.42);

/// Adds meshes and materials to the balls and cannons of any scene.
pub struct SharedMaterialsPlugin;

impl Plugin for SharedMaterialsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<SharedMaterials>()
            .add_systems(PostUpdate, aim_model.before(TransformSystems::Propagate))
            .add_observer(add_ball_mesh)
            .add_observer(build_cannon);
    }
}

/// The materials and meshes that bodies of the same kind share.
#[derive(Resource)]
pub struct SharedMaterials {
    /// The material of cloth.
    pub fabric: Handle<StandardMaterial>,
    /// The material of balls.
    pub ball: Handle<StandardMaterial>,
    /// A ball of radius 1.
    pub sphere: Handle<Mesh>,
}

impl FromWorld for SharedMaterials {
    fn from_world(world: &mut World) -> Self {
        let mut images = world.resource_mut::<Assets<Image>>();
        let (fabric, ball) = (images.add(textures::fabric()), images.add(textures::ball()));
        let sphere = world.resource_mut::<Assets<Mesh>>().add(Sphere::new(1.0).mesh().uv(64, 32));
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        Self {
            fabric: materials.add(StandardMaterial {
                base_color_texture: Some(fabric),
                perceptual_roughness: 0.85,
                reflectance: 0.2,
                // A little light comes through from behind.
                diffuse_transmission: 0.25,
                double_sided: true,
                cull_mode: None,
                ..default()
            }),
            ball: materials.add(StandardMaterial {
                base_color_texture: Some(ball),
                perceptual_roughness: 0.4,
                metallic: 0.3,
                ..default()
            }),
            sphere,
        }
    }
}

/// The mesh is a child of the ball, whose own transform belongs to the simulation.
fn add_ball_mesh(
    added: On<Add<Projectile>>,
    mut commands: Commands,
    balls: Query<(&Projectile, Option<&Paint>)>,
    shared: Res<SharedMaterials>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Ok((ball, paint)) = balls.get(added.entity) else {
        return;
    };
    let painted = paint.map(|paint| {
        materials.add(StandardMaterial { base_color: paint.color(), perceptual_roughness: 0.4, ..default() })
    });
    commands.entity(added.entity).insert((Interpolated, Visibility::default())).with_child((
        Mesh3d(shared.sphere.clone()),
        MeshMaterial3d(painted.unwrap_or(shared.ball.clone())),
        Transform::from_scale(Vec3::splat(ball.radius)),
    ));
}
