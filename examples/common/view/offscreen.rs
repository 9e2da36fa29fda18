//! Drawing without a window: an app that draws into an image, through whatever graphics adapter there is.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use bevy::app::{Plugins, PluginsState};
use bevy::camera::RenderTarget;
use bevy::light::DirectionalLightShadowMap;
use bevy::prelude::*;
use bevy::render::render_resource::{PipelineCache, TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::window::ExitCondition;
use thiserror::Error;

use crate::view::adapter::{NoAdapter, find_adapter};
use crate::view::asset_files::asset_plugin;
use crate::view::gltf_files::FileError;
use crate::view::lighting::camera;

/// Updates that a picture may take before it is given up.
const PATIENCE: u32 = 500;
/// Updates after which a new scene has reached the renderer: one to make the meshes, two to settle them.
const SETTLING: u32 = 4;

/// Why there are no pictures.
#[derive(Debug, Error)]
pub enum PictureError {
    /// Nothing to draw with.
    #[error(transparent)]
    NoAdapter(#[from] NoAdapter),
    /// The renderer did not come to an end.
    #[error("the renderer did not finish {0}")]
    NotDrawn(String),
    /// A file of the scene is missing.
    #[error(transparent)]
    NotLoaded(#[from] FileError),
    /// A picture cannot be written.
    #[error("cannot write {path}: {reason}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

/// A camera that draws into an image.
pub struct OffscreenCamera {
    target: Handle<Image>,
    camera: Entity,
}

/// An app that can draw without a window, with `plugins` and a camera for pictures of `size` pixels.
///
/// # Errors
/// [`PictureError::NoAdapter`].
pub fn app<M>(plugins: impl Plugins<M>, size: UVec2) -> Result<(App, OffscreenCamera), PictureError> {
    find_adapter()?;
    let mut app = App::new();
    let basics = DefaultPlugins
        .set(asset_plugin())
        .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
        .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
        // The updates are ours, and so are the picture and the terminal.
        .disable::<bevy::log::LogPlugin>();
    // A browser has neither the thread nor the terminal.
    #[cfg(not(target_family = "wasm"))]
    let basics = basics
        .disable::<bevy::render::pipelined_rendering::PipelinedRenderingPlugin>()
        .disable::<bevy::app::TerminalCtrlCHandlerPlugin>();
    #[cfg(feature = "window")]
    let basics = basics.disable::<bevy::winit::WinitPlugin>();
    app.add_plugins(basics)
        .add_plugins(plugins)
        // Seen for longer than a frame in a window.
        .insert_resource(DirectionalLightShadowMap { size: 4096 });
    while app.plugins_state() == PluginsState::Adding {
        // In a browser tasks run between frames.
        #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();

    let mut target = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
    target.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let world = app.world_mut();
    let target = world.resource_mut::<Assets<Image>>().add(target);
    let camera = camera(Transform::default(), &mut world.resource_mut::<Assets<Image>>());
    let camera = world.spawn((camera, RenderTarget::Image(target.clone().into()))).id();
    let offscreen = OffscreenCamera { target, camera };
    offscreen.set_camera_active(&mut app, false);
    Ok((app, offscreen))
}

impl OffscreenCamera {
    /// The camera.
    pub fn camera(&self) -> Entity {
        self.camera
    }

    /// Draws what `app` shows now into a PNG file. Its clock must stand still meanwhile.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn draw(&self, app: &mut App, path: &Path) -> Result<(), PictureError> {
        self.draw_at(app, path, 1)
    }

    /// The same at half the size, with smooth edges and small features.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn draw_half(&self, app: &mut App, path: &Path) -> Result<(), PictureError> {
        self.draw_at(app, path, 2)
    }

    fn draw_at(&self, app: &mut App, path: &Path, smaller: u32) -> Result<(), PictureError> {
        let image = self.picture(app).ok_or_else(|| PictureError::NotDrawn(path.display().to_string()))?;
        let reason = |error: &dyn core::fmt::Display| PictureError::File {
            path: path.to_path_buf(),
            reason: error.to_string(),
        };
        let picture = image.try_into_dynamic().map_err(|error| reason(&error))?;
        let picture = match smaller {
            1 => picture,
            _ => picture.thumbnail(picture.width() / smaller, picture.height() / smaller),
        };
        picture.to_rgb8().save(path).map_err(|error| reason(&error))
    }

    fn picture(&self, app: &mut App) -> Option<Image> {
        // Drawing may take seconds: nothing is drawn until there is something to see.
        for _ in 0..SETTLING {
            app.update();
        }
        self.set_camera_active(app, true);
        for _ in 0..PATIENCE {
            app.update();
            if is_ready(app) {
                break;
            }
        }
        let pictures = self.take_picture(app);
        for _ in 0..PATIENCE {
            app.update();
            self.set_camera_active(app, false);
            match pictures.try_recv() {
                Ok(image) => return Some(image),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => break,
            }
        }
        None
    }

    fn set_camera_active(&self, app: &mut App, is_active: bool) {
        if let Some(mut camera) = app.world_mut().get_mut::<Camera>(self.camera) {
            camera.is_active = is_active;
        }
    }

    fn take_picture(&self, app: &mut App) -> Receiver<Image> {
        let (sender, receiver) = channel();
        let send = move |captured: On<ScreenshotCaptured>| {
            // An error means that nobody waits for the picture any more.
            let _ = sender.send(captured.image.clone());
        };
        app.world_mut().spawn(Screenshot::image(self.target.clone())).observe(send);
        receiver
    }
}

/// True if every shader that was asked for is compiled.
fn is_ready(app: &App) -> bool {
    let renderer = app.get_sub_app(RenderApp);
    let cache = renderer.and_then(|renderer| renderer.world().get_resource::<PipelineCache>());
    cache.is_some_and(|cache| cache.waiting_pipelines().next().is_none())
}
