//! The demo in a window: aim, fire, drag the curtain.

use bevy::light::DirectionalLightShadowMap;
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use bevy_drape::prelude::*;
use bevy_drape::sleep::SceneManager;
use wgpu::DeviceType;

use crate::cannon_demo::arguments::Arguments;
use crate::cannon_demo::controls::ControlsPlugin;
use crate::cannon_demo::headless::task_pools;
use crate::cannon_demo::materials::CannonMaterialsPlugin;
use crate::cannon_demo::overlay::OverlayPlugin;
use crate::cannon_demo::plugin::CannonScenePlugin;
use crate::cannon_demo::scene::CannonScene;
use crate::view::IN_PAGE;
use crate::view::lighting::camera;
use crate::view::orbit::{Orbit, OrbitPlugin};
use crate::view::pointer::PointerPlugin;
use crate::view::window::{WindowError, check_display, main_window};

/// Half the side of the play area in metres: balls that roll out of it are taken away.
const PLAY_AREA: f32 = 60.0;

/// Opens the window and stays until it is closed.
///
/// # Errors
/// `WindowError` if there is no display or no graphics adapter.
pub fn run(arguments: &Arguments) -> Result<AppExit, WindowError> {
    check_display()?;
    // The player fires; the address of a page may ask for shots.
    let shots = if IN_PAGE { arguments.shots } else { 0 };
    let scene = CannonScene { shots, ..arguments.scene() };
    let plugins = DefaultPlugins
        .set(main_window("bevy_drape: a cannon bombards a curtain"))
        .set(task_pools(arguments.threads));
    let mut app = App::new();
    app.add_plugins((plugins, DrapePlugins::default(), CannonMaterialsPlugin, CannonScenePlugin(scene)))
        .add_plugins((OrbitPlugin, ControlsPlugin, PointerPlugin, OverlayPlugin))
        .insert_resource(SceneManager {
            play_area_min: Vec3::splat(-PLAY_AREA),
            play_area_max: Vec3::splat(PLAY_AREA),
            despawn_lost_balls: true,
            ..default()
        })
        .add_systems(Startup, spawn_camera);
    #[cfg(all(feature = "web", target_family = "wasm"))]
    app.add_plugins(crate::cannon_demo::page::CannonPagePlugin);
    Ok(app.run())
}

/// Behind the cannon, on its left.
fn spawn_camera(mut commands: Commands, mut images: ResMut<Assets<Image>>, adapter: Res<RenderAdapterInfo>) {
    let orbit = Orbit { target: Vec3::new(0.4, 1.4, 5.0), yaw: -0.3, pitch: 0.08, distance: 13.5 };
    let mut camera = commands.spawn((orbit, camera(orbit.transform(), &mut images)));
    if adapter.device_type == DeviceType::Cpu {
        // A software renderer is slow enough.
        camera.insert(Msaa::Off);
        commands.insert_resource(DirectionalLightShadowMap { size: 1024 });
    }
}
