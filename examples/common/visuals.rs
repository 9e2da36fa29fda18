//! What the scene looks like, in a window and in pictures: materials, meshes, light, camera.
//!
//! The scene itself knows nothing of this: observers dress whatever is added to the world.

use core::f32::consts::FRAC_PI_2;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{CascadeShadowConfigBuilder, NotShadowCaster, NotShadowReceiver};
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::cannon_model::{aim_model, build_cannon};
use crate::feature::Paint;
use crate::scene::{Curtain, Ground, curtain_clearance, curtain_size};
use crate::textures;

/// Colour of the sky, and of what is far away.
const SKY: Srgba = Srgba::rgb(0.79, 0.83, 0.86);
/// Colour of the ground.
pub const EARTH: Color = Color::srgb(0.50, 0.47, 0.42);

/// Dresses the scene of the cannon demo.
pub struct VisualsPlugin;

impl Plugin for VisualsPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(OutdoorsPlugin)
            .add_systems(Startup, spawn_frame)
            .add_observer(dress_curtain)
            .add_observer(dress_ground);
    }
}

/// Sun and sky, and what balls and cannons look like in any scene.
pub struct OutdoorsPlugin;

impl Plugin for OutdoorsPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(ClearColor(SKY.into()))
            .init_resource::<Wardrobe>()
            .add_systems(Startup, (spawn_light, spawn_sky))
            .add_systems(PostUpdate, aim_model.before(TransformSystems::Propagate))
            .add_observer(dress_ball)
            .add_observer(build_cannon);
    }
}

/// What bodies of the same kind share.
#[derive(Resource)]
pub struct Wardrobe {
    /// What cloth is made of.
    pub fabric: Handle<StandardMaterial>,
    /// What balls are made of.
    pub ball: Handle<StandardMaterial>,
    /// A ball of radius 1.
    pub sphere: Handle<Mesh>,
}

impl FromWorld for Wardrobe {
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

/// A camera for this scene at `transform`.
pub fn camera(transform: Transform, images: &mut Assets<Image>) -> impl Bundle {
    let up = Color::srgb(0.80, 0.88, 1.0);
    let mut light =
        EnvironmentMapLight::hemispherical_gradient(images, up, SKY, Color::srgb(0.50, 0.42, 0.34));
    light.intensity = 900.0;
    let fog = DistanceFog {
        color: SKY.into(),
        falloff: FogFalloff::Linear { start: 25.0, end: 90.0 },
        ..default()
    };
    let projection = PerspectiveProjection { fov: 40.0_f32.to_radians(), ..default() };
    (
        Camera3d::default(),
        Projection::Perspective(projection),
        // One that needs no look-up table to be loaded.
        Tonemapping::KhronosPbrNeutral,
        Msaa::Sample4,
        light,
        fog,
        Viewer,
        transform,
    )
}

fn spawn_light(mut commands: Commands) {
    commands.spawn((
        DirectionalLight {
            color: Color::srgb(1.0, 0.95, 0.86),
            illuminance: 7_500.0,
            shadow_maps_enabled: true,
            ..default()
        },
        CascadeShadowConfigBuilder {
            num_cascades: 3,
            first_cascade_far_bound: 7.0,
            maximum_distance: 40.0,
            ..default()
        }
        .build(),
        // From the right of the cannon and above: it grazes the curtain, so that folds are seen.
        Transform::from_xyz(6.0, 6.5, 4.5).looking_at(Vec3::ZERO, Vec3::Y),
        Name::new("sun"),
    ));
}

fn spawn_sky(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    let material = StandardMaterial {
        base_color_texture: Some(images.add(textures::sky(SKY))),
        unlit: true,
        fog_enabled: false,
        cull_mode: None,
        ..default()
    };
    commands.spawn((
        Mesh3d(meshes.add(Sphere::new(200.0).mesh().uv(32, 32))),
        MeshMaterial3d(materials.add(material)),
        // The sphere's poles are on its Z axis.
        Transform::from_rotation(Quat::from_rotation_x(-FRAC_PI_2)),
        NotShadowCaster,
        NotShadowReceiver,
    ));
}

/// Rod and posts that the curtain hangs from. Only to look at.
fn spawn_frame(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let material = materials.add(StandardMaterial {
        base_color: Color::srgb(0.30, 0.20, 0.13),
        perceptual_roughness: 0.6,
        ..default()
    });
    let (half_width, top) = (0.5 * curtain_size().x + 0.2, curtain_clearance() + curtain_size().y + 0.02);
    let mut spawn = |mesh: Mesh, transform: Transform| {
        commands.spawn((Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()), transform));
    };
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    spawn(
        Cylinder::new(0.03, 2.0 * half_width + 0.2).mesh().build(),
        Transform::from_xyz(0.0, top, 0.0).with_rotation(lying),
    );
    for side in [-1.0, 1.0] {
        let x = side * half_width;
        spawn(Cylinder::new(0.05, top).mesh().build(), Transform::from_xyz(x, 0.5 * top, 0.0));
        spawn(Cylinder::new(0.16, 0.08).mesh().build(), Transform::from_xyz(x, 0.04, 0.0));
        let knob = x + side * 0.12;
        spawn(Sphere::new(0.06).mesh().uv(24, 16), Transform::from_xyz(knob, top, 0.0));
    }
}

fn dress_curtain(added: On<Add, Curtain>, mut commands: Commands, wardrobe: Res<Wardrobe>) {
    commands.entity(added.entity).insert(MeshMaterial3d(wardrobe.fabric.clone()));
}

fn dress_ground(
    added: On<Add, Ground>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let material =
        StandardMaterial { base_color: EARTH, perceptual_roughness: 0.95, reflectance: 0.1, ..default() };
    commands.entity(added.entity).insert((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(600.0, 600.0))),
        MeshMaterial3d(materials.add(material)),
    ));
}

/// A ball's looks are a child of it: its own transform belongs to the simulation.
fn dress_ball(
    added: On<Add, Projectile>,
    mut commands: Commands,
    balls: Query<(&Projectile, Option<&Paint>)>,
    wardrobe: Res<Wardrobe>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Ok((ball, paint)) = balls.get(added.entity) else {
        return;
    };
    let painted = paint.map(|&Paint(colour)| {
        materials.add(StandardMaterial { base_color: colour, perceptual_roughness: 0.4, ..default() })
    });
    commands.entity(added.entity).insert((Interpolated, Visibility::default())).with_child((
        Mesh3d(wardrobe.sphere.clone()),
        MeshMaterial3d(painted.unwrap_or(wardrobe.ball.clone())),
        Transform::from_scale(Vec3::splat(ball.radius)),
    ));
}
