//! Pictures of scenes without a window: at the beginning, in the middle and at the end by every camera, at the pictures of
//! the timeline, and if an expectation fails.

use core::time::Duration;
use std::path::{Path, PathBuf};

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape_script::play::{PictureDue, ScenePlay, ScenePlugin};
use bevy_drape_script::{SceneRunner, SceneScript};

use crate::scripted::framing::{Framing, viewpoint_of};
use crate::scripted::materials::SceneMaterialsPlugin;
use crate::view::offscreen::{self, OffscreenCamera, PictureError};
use crate::view::viewpoint::Viewpoint;

/// Size of a picture in pixels.
const SIZE: UVec2 = UVec2::new(960, 540);
/// Pictures show the end of the last step: nearly all of it has passed.
const OVERSTEP: f64 = 0.999;
/// The name of the view of a scene without cameras.
const WHOLE: &str = "whole";

/// Draws pictures of scenes, one after another, into a folder.
pub struct PictureWriter {
    /// None while a runner has it.
    app: Option<App>,
    offscreen: OffscreenCamera,
    folder: PathBuf,
    due: MessageCursor<PictureDue>,
    framing: Framing,
    /// Number of steps after which the last pictures were drawn.
    drawn: u64,
    /// Indices of the failed expectations that were drawn.
    broken: Vec<usize>,
}

impl PictureWriter {
    /// A writer that draws into `folder`.
    ///
    /// # Errors
    /// [`PictureError::NoAdapter`].
    pub fn open(folder: &Path) -> Result<Self, PictureError> {
        let (app, offscreen) =
            offscreen::app((DrapePlugins::default(), SceneMaterialsPlugin, ScenePlugin), SIZE)?;
        Ok(Self {
            app: Some(app),
            offscreen,
            folder: folder.to_path_buf(),
            due: MessageCursor::default(),
            framing: Framing::default(),
            drawn: 0,
            broken: Vec::new(),
        })
    }

    /// A runner of `script` in the app that draws.
    pub fn runner(&mut self, script: SceneScript) -> SceneRunner {
        (self.framing, self.drawn, self.broken) = (Framing::default(), 0, Vec::new());
        match self.app.take() {
            Some(mut app) => {
                // As in an app of its own, time begins with the scene.
                app.insert_resource(DrapeClock::default());
                SceneRunner::new(app, script)
            }
            None => SceneRunner::headless(script),
        }
    }

    /// Takes the app back.
    pub fn close(&mut self, runner: SceneRunner) {
        self.app = Some(runner.into_app());
    }

    /// Draws the pictures that are due after the step that `runner` has just taken.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn look(&mut self, runner: &mut SceneRunner, name: &str) -> Result<(), PictureError> {
        let middle = runner.greatest_steps() / 2;
        let app = runner.app_mut();
        self.framing.note(app.world_mut());
        let Some(messages) = app.world().get_resource::<Messages<PictureDue>>() else { return Ok(()) };
        let due: Vec<String> = self.due.read(messages).map(|due| due.camera.clone()).collect();
        let Some(play) = app.world().get_resource::<ScenePlay>() else { return Ok(()) };
        let (steps, is_over) = (play.steps(), play.is_over());
        let mut titles = Vec::new();
        for camera in due {
            titles.push((camera.clone(), format!("{camera}.at_step_{steps:05}")));
        }
        let verdicts = play.verdicts();
        let broken: Vec<usize> = play.broken().filter(|index| !self.broken.contains(index)).collect();
        let cameras = self.cameras(play);
        for &index in &broken {
            eprintln!("{name}: {} (picture)", verdicts[index]);
            titles.push((cameras[0].0.clone(), format!("failed_{}", index + 1)));
        }
        let moment = match steps {
            _ if self.drawn == steps => None,
            _ if is_over => Some("3_end"),
            1 => Some("1_start"),
            _ if steps == middle => Some("2_middle"),
            _ => None,
        };
        if let Some(moment) = moment {
            self.drawn = steps;
            titles.extend(cameras.iter().map(|(camera, _)| (camera.clone(), format!("{camera}.{moment}"))));
        }
        self.broken.extend(broken);
        for (camera, title) in titles {
            if let Some((_, view)) = cameras.iter().find(|(name, _)| *name == camera) {
                let path = self.folder.join(format!("{name}.{title}.png"));
                self.draw(app, view, &path)?;
                eprintln!("{}", path.display());
            }
        }
        Ok(())
    }

    /// The scene's cameras by their names; one that sees all of it, if it has none.
    fn cameras(&self, play: &ScenePlay) -> Vec<(String, Viewpoint)> {
        let own = play.script().cameras.iter().map(|(name, camera)| (name.clone(), viewpoint_of(camera)));
        let own: Vec<_> = own.collect();
        if own.is_empty() { vec![(WHOLE.to_string(), self.framing.view())] } else { own }
    }

    fn draw(&self, app: &mut App, view: &Viewpoint, path: &Path) -> Result<(), PictureError> {
        let world = app.world_mut();
        let mut cameras = world.query::<(&mut Transform, &mut Projection)>();
        if let Ok((mut transform, mut projection)) = cameras.get_mut(world, self.offscreen.camera()) {
            view.apply(&mut transform, &mut projection);
        }
        let still = TimeUpdateStrategy::ManualDuration(Duration::ZERO);
        let strategy = core::mem::replace(&mut *world.resource_mut::<TimeUpdateStrategy>(), still);
        let mut fixed = world.resource_mut::<Time<Fixed>>();
        let overstep = fixed.timestep().mul_f64(OVERSTEP);
        fixed.accumulate_overstep(overstep);
        let drawn = self.offscreen.draw(app, path);
        let world = app.world_mut();
        world.resource_mut::<Time<Fixed>>().discard_overstep(overstep);
        world.insert_resource(strategy);
        drawn
    }
}
