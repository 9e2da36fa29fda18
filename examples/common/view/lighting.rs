//! Sun, sky, and the camera that looks at them.

use core::f32::consts::{FRAC_PI_2, PI};

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{CascadeShadowConfigBuilder, NotShadowCaster, NotShadowReceiver};
use bevy::prelude::*;
use bevy_drape::viewer::Viewer;

use crate::view::{IN_PAGE, textures};

/// Colour of the sky, and of what is far away.
const SKY: Srgba = Srgba::rgb(0.79, 0.83, 0.86);
/// The sky from the other side than the sun, or all that is in the shade has one and the same grey: colour, illuminance in lux, direction.
const FILL: Color = Color::srgb(0.72, 0.84, 1.0);
const FILL_ILLUMINANCE: f32 = 1_100.0;
const FILL_FROM: Vec3 = Vec3::new(-6.0, 3.0, 1.5);
/// Maps of the sun's shadow, one for what is near, one for what is far away, one between. WebGL2 draws only one.
const SHADOW_MAPS: usize = if IN_PAGE { 1 } else { 3 };

/// Sun and sky.
pub struct LightingPlugin;

impl Plugin for LightingPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(ClearColor(SKY.into())).add_systems(Startup, (spawn_light, spawn_sky));
    }
}

/// A camera for this scene at `transform`.
pub fn camera(transform: Transform, images: &mut Assets<Image>) -> impl Bundle {
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
        surroundings(images),
        fog,
        Viewer,
        transform,
    )
}

/// Light from all sides.
fn surroundings(images: &mut Assets<Image>) -> EnvironmentMapLight {
    let up = Color::srgb(0.80, 0.88, 1.0);
    let mut light =
        EnvironmentMapLight::hemispherical_gradient(images, up, SKY, Color::srgb(0.50, 0.42, 0.34));
    light.intensity = 900.0;
    if IN_PAGE && let Some(mut sides) = images.get_mut(&light.diffuse_map) {
        add_fill(&mut sides, light.intensity);
    }
    light
}

/// Adds the fill to a map of light from all sides: WebGL2 draws only one directional light, and that is the sun.
fn add_fill(sides: &mut Image, intensity: f32) {
    let fill = FILL.to_linear() * (FILL_ILLUMINANCE / (PI * intensity));
    // Z points the other way in a cube of textures.
    let normals = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Z, Vec3::Z];
    for (side, normal) in (0..).zip(normals) {
        let part = FILL_FROM.normalize().dot(normal).max(0.0);
        if let Ok(colour) = sides.get_color_at_3d(0, 0, side) {
            let sum = colour.to_linear() + fill * part;
            // It fails only outside of the image.
            sides.set_color_at_3d(0, 0, side, sum.into()).ok();
        }
    }
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
            num_cascades: SHADOW_MAPS,
            first_cascade_far_bound: 7.0,
            maximum_distance: 40.0,
            ..default()
        }
        .build(),
        // From the right of the cannon and above: it grazes the curtain, so that folds are seen.
        Transform::from_xyz(6.0, 6.5, 4.5).looking_at(Vec3::ZERO, Vec3::Y),
        Name::new("sun"),
    ));
    if IN_PAGE {
        return;
    }
    commands.spawn((
        DirectionalLight { color: FILL, illuminance: FILL_ILLUMINANCE, ..default() },
        Transform::from_translation(FILL_FROM).looking_at(Vec3::ZERO, Vec3::Y),
        Name::new("fill"),
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
