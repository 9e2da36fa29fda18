//! Runs scenes without a window.

use std::path::{Path, PathBuf};
use std::time::Instant;

use bevy::app::PluginsState;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

use super::report::Report;
use super::scene_files::scene_name;
use super::step_times;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::load::Override;
use crate::play::{ScenePlay, ScenePlugin, begin_scene};
use crate::scene::SceneScript;

/// Runs a scene step by step, as fast as possible.
///
/// ```
/// use bevy_drape_script::{SceneRunner, SceneScript};
///
/// let script = SceneScript::parse(r#"(
///     version: 1,
///     settings: (duration: 1),
///     bodies: { "ball": Balls(at: (0, 10, 0)) },
///     expectations: [
///         // It falls g t^2 / 2.
///         (probe: Position(of: "ball", axis: Y), expect: Near(value: 5.095, tolerance: 0.001)),
///     ],
/// )"#)?;
/// SceneRunner::headless(script).run().assert_passed();
/// # Ok::<(), bevy_drape_script::SceneError>(())
/// ```
pub struct SceneRunner {
    app: App,
    name: String,
    file: Option<PathBuf>,
    recording: Option<PathBuf>,
    began: Instant,
}

impl SceneRunner {
    /// A runner of `script` in an app of its own, with nothing but the plugin.
    pub fn headless(script: SceneScript) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, DrapePlugins::default()));
        Self::new(app, script)
    }

    /// A runner of `script` in `app`, which must have [`DrapePlugins`] and Bevy's time and tasks. From now on each
    /// update of the app takes one step.
    pub fn new(app: App, script: SceneScript) -> Self {
        let mut runner = Self::ready(app);
        begin_scene(runner.world_mut(), script);
        // The first update has no time delta and takes no step.
        runner.app.update();
        runner
    }

    /// A runner that resumes the scene of `checkpoint`, in an app of its own.
    ///
    /// # Errors
    /// [`CheckpointError`] if it holds no scene, or one that contradicts itself.
    pub fn resume(checkpoint: &Checkpoint) -> Result<Self, CheckpointError> {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, DrapePlugins::default()));
        let mut runner = Self::ready(app).named(checkpoint.scene());
        runner.app.update();
        checkpoint.resume(runner.world_mut())?;
        Ok(runner)
    }

    /// A runner without a scene.
    fn ready(mut app: App) -> Self {
        if !app.is_plugin_added::<ScenePlugin>() {
            app.add_plugins(ScenePlugin);
        }
        while app.plugins_state() == PluginsState::Adding {
            // In a browser tasks run between frames.
            #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        // An app that has run a scene before was finished then.
        if app.plugins_state() != PluginsState::Cleaned {
            app.finish();
            app.cleanup();
        }
        app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        Self { app, name: String::from("scene"), file: None, recording: None, began: Instant::now() }
    }

    /// Names the scene, for the report.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Sets the file of the scene, for the report, and names the scene after it.
    #[must_use]
    pub fn from_file(self, path: &Path) -> Self {
        Self { file: Some(path.to_path_buf()), ..self.named(scene_name(path)) }
    }

    /// Sets the file of the run's recording, for the report.
    pub fn note_recording(&mut self, path: impl Into<PathBuf>) {
        self.recording = Some(path.into());
    }

    /// Returns the app, to run another scene in.
    pub fn into_app(self) -> App {
        self.app
    }

    /// The app of the scene.
    pub fn app_mut(&mut self) -> &mut App {
        &mut self.app
    }

    /// The world of the scene.
    pub fn world(&self) -> &World {
        self.app.world()
    }

    /// The world of the scene, mutably.
    pub fn world_mut(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// The greatest number of steps that the scene takes.
    pub fn greatest_steps(&self) -> u64 {
        let settings = self.world().get_resource::<ScenePlay>().map(|play| play.script().settings.clone());
        settings.map_or(0, |settings| (settings.duration.get() / settings.dt.get()).ceil() as u64)
    }

    /// Returns true once the last step has been taken.
    pub fn is_over(&self) -> bool {
        self.world().get_resource::<ScenePlay>().is_none_or(ScenePlay::is_over)
    }

    /// Takes one step, unless the scene is over or paused by its own timeline. Returns true while the scene goes on.
    pub fn step(&mut self) -> bool {
        if !self.is_over() {
            self.app.update();
        }
        !self.is_over()
    }

    /// Takes all steps.
    pub fn run(self) -> Report {
        self.run_with(|_, _| {})
    }

    /// Takes all steps, and passes the world to `look` after each, with the number of steps taken so far.
    pub fn run_with(mut self, mut look: impl FnMut(&mut World, u64)) -> Report {
        let mut steps = 0;
        loop {
            let goes_on = self.step();
            let taken = self.world().get_resource::<ScenePlay>().map_or(0, ScenePlay::steps);
            if taken > steps {
                steps = taken;
                look(self.world_mut(), steps);
            }
            if !goes_on {
                return self.report();
            }
        }
    }

    /// The report so far; complete after the last step.
    pub fn report(&mut self) -> Report {
        let wall_s = self.began.elapsed().as_secs_f64();
        let world = self.app.world();
        let Some(play) = world.get_resource::<ScenePlay>() else {
            return Report::failed(
                self.name.clone(),
                self.file.clone(),
                "the scene has been taken out of the world",
            );
        };
        let mut report = Report {
            scene: self.name.clone(),
            file: self.file.clone(),
            recording: self.recording.clone(),
            steps: play.steps(),
            simulated_s: play.steps() as f64 * play.script().settings.dt.get(),
            wall_s,
            state_hash: format!("{:016x}", play.state_hash(world)),
            verdicts: play.verdicts(),
            problems: play.problems().to_vec(),
            notes: play.notes(),
        };
        if report.verdicts.is_empty() {
            report.notes.push("nothing is expected".to_string());
        }
        step_times::measure(play.script(), &mut report.verdicts);
        report
    }
}

/// Loads the scene in the file at `path`, runs it, and reports. Errors in the file become problems of the report.
///
/// ```no_run
/// # use bevy_drape_script::run_scene;
/// #[test]
/// fn curtain() {
///     run_scene("assets/scenes/curtain.scene.ron").assert_passed();
/// }
/// ```
pub fn run_scene(path: impl AsRef<Path>) -> Report {
    run_scene_with(path, &[])
}

/// Loads, runs and reports the scene in the file at `path`, with some values replaced.
pub fn run_scene_with(path: impl AsRef<Path>, overrides: &[Override]) -> Report {
    let path = path.as_ref();
    match SceneScript::load_with(path, overrides) {
        Ok(script) => SceneRunner::headless(script).from_file(path).run(),
        Err(error) => Report::failed(scene_name(path), Some(path.to_path_buf()), &error.to_string()),
    }
}
