//! A window with sky, camera and texts: the base of the windows of scenes, recordings and features.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use thiserror::Error;

use crate::view::IN_PAGE;
use crate::view::adapter::{NoAdapter, find_adapter};
use crate::view::asset_files::asset_plugin;
use crate::view::lighting::camera;
use crate::view::orbit::{Orbit, OrbitPlugin};
use crate::view::text_panel::{spawn_panel, write_panel};

/// Why there is no window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum WindowError {
    /// Nothing to open a window on.
    #[error("no display to open a window on; `--headless` needs none")]
    NoDisplay,
    /// Nothing to draw with.
    #[error("{0}; `--headless` needs none")]
    NoAdapter(#[from] NoAdapter),
}

/// Makes sure that a window can be opened and drawn into: the window library and the renderer panic where they cannot.
///
/// # Errors
/// [`WindowError`].
pub(crate) fn check_display() -> Result<(), WindowError> {
    // A page cannot wait for an adapter, and looks for WebGL2 itself.
    if IN_PAGE {
        return Ok(());
    }
    if !has_display() {
        return Err(WindowError::NoDisplay);
    }
    find_adapter()?;
    Ok(())
}

fn has_display() -> bool {
    let is_set = |name: &&str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let asks = cfg!(all(unix, not(target_vendor = "apple")));
    !asks || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].iter().any(is_set)
}

/// The main window; in a browser, the page's canvas.
pub(crate) fn main_window(title: &str) -> WindowPlugin {
    let window = Window {
        title: title.to_owned(),
        resolution: UVec2::new(1280, 720).into(),
        canvas: Some("#canvas".to_owned()),
        fit_canvas_to_parent: true,
        // Keys of the browser stay keys of the browser.
        prevent_default_event_handling: false,
        ..default()
    };
    WindowPlugin { primary_window: Some(window), ..default() }
}

/// Ends the program; a page stays.
pub(crate) fn quit(keys: Res<ButtonInput<KeyCode>>, mut exit: MessageWriter<AppExit>) {
    if keys.just_pressed(KeyCode::Escape) && !IN_PAGE {
        exit.write(AppExit::Success);
    }
}

/// A window without meshes and materials for bodies and obstacles.
///
/// # Errors
/// [`WindowError`] if there is no display, or nothing to draw with.
pub(crate) fn bare_app(title: &str) -> Result<App, WindowError> {
    check_display()?;
    let plugins = DefaultPlugins.set(asset_plugin()).set(main_window(title));
    let mut app = App::new();
    app.add_plugins((plugins, DrapePlugins::default(), OrbitPlugin))
        .add_systems(Startup, (spawn_camera, spawn_panel))
        .add_systems(Update, quit)
        .add_systems(PostUpdate, write_panel);
    #[cfg(all(feature = "web", target_family = "wasm"))]
    app.add_plugins(crate::view::page::PagePlugin);
    Ok(app)
}

fn spawn_camera(mut commands: Commands, mut images: ResMut<Assets<Image>>) {
    let orbit = Orbit { target: Vec3::Y, yaw: 0.4, pitch: 0.25, distance: 8.0 };
    commands.spawn((orbit, camera(orbit.transform(), &mut images)));
}
