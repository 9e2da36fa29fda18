//! Pictures of a run without a window: PNG files, drawn through whatever graphics adapter there is.
//!
//! The moments were kept while the scene was simulated ([`moments`](crate::moments)); here a second app, whose
//! clock stands still, shows them one after the other.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use bevy::app::{PluginsState, TerminalCtrlCHandlerPlugin};
use bevy::camera::RenderTarget;
use bevy::light::DirectionalLightShadowMap;
use bevy::prelude::*;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PipelineCache, TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::render::{RenderApp, RenderPlugin};
use bevy::tasks::tick_global_task_pools_on_main_thread;
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy_drape::prelude::*;
use thiserror::Error;

use crate::adapter::{NoAdapter, find_adapter};
use crate::moments::Snapshot;
use crate::scene::{CannonScene, Curtain, Ground, STEP};
use crate::visuals::{VisualsPlugin, camera};

/// Size of a picture in pixels.
const SIZE: UVec2 = UVec2::new(1280, 720);
/// Updates that a picture may take before it is given up.
const PATIENCE: u32 = 500;
/// Updates after which a new scene has reached the renderer: one to make the meshes, two to settle them.
const SETTLING: u32 = 4;

/// Why there are no pictures.
#[derive(Debug, Error)]
pub enum FramesError {
    /// Nothing to draw with.
    #[error(transparent)]
    NoAdapter(#[from] NoAdapter),
    /// The renderer did not come to an end.
    #[error("the renderer did not finish {0}")]
    NotDrawn(&'static str),
    /// A picture cannot be written.
    #[error("cannot write {path}: {reason}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

/// Draws `snapshots` of `scene` into `folder`, one PNG file each, and tells `on_frame` of each.
///
/// # Errors
/// [`FramesError`]: no adapter, or a file that cannot be written.
pub fn draw(
    snapshots: &[Snapshot],
    scene: &CannonScene,
    folder: &Path,
    mut on_frame: impl FnMut(&Path),
) -> Result<(), FramesError> {
    find_adapter()?;
    let mut studio = Studio::new();
    for snapshot in snapshots {
        let path = folder.join(snapshot.name).with_extension("png");
        let image = studio.draw(snapshot, scene)?;
        let reason = |error: &dyn core::fmt::Display| FramesError::File {
            path: path.clone(),
            reason: error.to_string(),
        };
        let picture = image.try_into_dynamic().map_err(|error| reason(&error))?;
        picture.to_rgb8().save(&path).map_err(|error| reason(&error))?;
        on_frame(&path);
    }
    Ok(())
}

/// Marks what belongs to the snapshot that is shown.
#[derive(Component)]
struct Pictured;

/// An app that draws into an image.
struct Studio {
    app: App,
    target: Handle<Image>,
    camera: Entity,
}

impl Studio {
    fn new() -> Self {
        let mut app = App::new();
        let plugins = DefaultPlugins
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
            // The updates are ours, and so are the picture and the terminal.
            .disable::<PipelinedRenderingPlugin>()
            .disable::<bevy::log::LogPlugin>()
            .disable::<TerminalCtrlCHandlerPlugin>();
        #[cfg(feature = "window")]
        let plugins = plugins.disable::<bevy::winit::WinitPlugin>();
        app.add_plugins((plugins, DrapePlugins::default(), VisualsPlugin))
            .insert_resource(Time::<Fixed>::from_seconds(STEP))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
            // Seen for longer than a frame in a window.
            .insert_resource(DirectionalLightShadowMap { size: 4096 });
        app.world_mut().resource_mut::<DrapeClock>().paused = true;
        while app.plugins_state() == PluginsState::Adding {
            tick_global_task_pools_on_main_thread();
        }
        app.finish();
        app.cleanup();

        let format = TextureFormat::Rgba8UnormSrgb;
        let mut target = Image::new_target_texture(SIZE.x, SIZE.y, format, None);
        target.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let world = app.world_mut();
        let target = world.resource_mut::<Assets<Image>>().add(target);
        let camera = camera(Transform::default(), &mut world.resource_mut::<Assets<Image>>());
        let camera = world.spawn((camera, RenderTarget::Image(target.clone().into()))).id();
        world.spawn((Ground, Transform::default()));
        Self { app, target, camera }
    }

    fn draw(&mut self, snapshot: &Snapshot, scene: &CannonScene) -> Result<Image, FramesError> {
        self.show(snapshot, scene);
        // Drawing may take seconds: nothing is drawn until there is something to see.
        self.set_camera_active(false);
        for _ in 0..SETTLING {
            self.app.update();
        }
        self.set_camera_active(true);
        for _ in 0..PATIENCE {
            self.app.update();
            if self.is_ready() {
                break;
            }
        }
        let pictures = self.take_picture();
        for _ in 0..PATIENCE {
            self.app.update();
            self.set_camera_active(false);
            match pictures.try_recv() {
                Ok(image) => return Ok(image),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => break,
            }
        }
        Err(FramesError::NotDrawn(snapshot.name))
    }

    fn set_camera_active(&mut self, is_active: bool) {
        if let Some(mut camera) = self.app.world_mut().get_mut::<Camera>(self.camera) {
            camera.is_active = is_active;
        }
    }

    /// Puts the scene of `snapshot` into the world, instead of the one before.
    fn show(&mut self, snapshot: &Snapshot, scene: &CannonScene) {
        let world = self.app.world_mut();
        let mut pictured = world.query_filtered::<Entity, With<Pictured>>();
        for entity in pictured.iter(world).collect::<Vec<_>>() {
            world.despawn(entity);
        }
        let body = (snapshot.particles.clone(), snapshot.sticks.clone());
        world.spawn((Pictured, scene.curtain(), body));
        for &(ball, transform) in &snapshot.balls {
            world.spawn((Pictured, ball, transform));
        }
        if let Some((cannon, transform)) = snapshot.cannon {
            world.spawn((Pictured, cannon, transform));
        }
        world.entity_mut(self.camera).insert(snapshot.camera());
    }

    /// Whether every shader that was asked for is compiled, and the curtain has its mesh.
    fn is_ready(&mut self) -> bool {
        let world = self.app.world_mut();
        let has_mesh = world.query_filtered::<(), (With<Curtain>, With<Mesh3d>)>().iter(world).count() > 0;
        let renderer = self.app.get_sub_app(RenderApp);
        let cache = renderer.and_then(|renderer| renderer.world().get_resource::<PipelineCache>());
        has_mesh && cache.is_some_and(|cache| cache.waiting_pipelines().next().is_none())
    }

    fn take_picture(&mut self) -> Receiver<Image> {
        let (sender, receiver) = channel();
        let send = move |captured: On<ScreenshotCaptured>| {
            // Nobody waits for it any more: nothing to do.
            let _ = sender.send(captured.image.clone());
        };
        self.app.world_mut().spawn(Screenshot::image(self.target.clone())).observe(send);
        receiver
    }
}
