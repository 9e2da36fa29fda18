//! The demo without a window: as fast as the machine can, with a report at the end.

use std::path::Path;
use std::time::Instant;

use bevy::app::TaskPoolThreadAssignmentPolicy;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::sleep::ActivityCounts;

use crate::cannon_demo::arguments::Arguments;
use crate::cannon_demo::output::{Output, OutputError};
use crate::cannon_demo::plugin::CannonScenePlugin;
use crate::cannon_demo::recorder::{Recorder, RecorderPlugin};
use crate::cannon_demo::scene::CannonScene;
use crate::cannon_demo::shot::{FIRST_SHOT, SHOT_INTERVAL};
use crate::progress::Progress;

/// The longest time that the run goes on after the last hit, in seconds.
const PATIENCE: f64 = 40.0;

/// The demo as an app that takes exactly one step in every update but the first, which takes none.
pub fn app(scene: CannonScene, threads: u16) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins.set(task_pools(threads)), DrapePlugins::default()))
        .add_plugins((CannonScenePlugin(scene), RecorderPlugin))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app
}

/// Task pools with this many threads for islands.
pub fn task_pools(threads: u16) -> TaskPoolPlugin {
    let mut plugin = TaskPoolPlugin::default();
    plugin.task_pool_options.compute = TaskPoolThreadAssignmentPolicy {
        min_threads: usize::from(threads),
        max_threads: usize::from(threads),
        percent: 1.0,
        on_thread_spawn: None,
        on_thread_destroy: None,
    };
    plugin
}

/// Runs the whole experiment and writes its results.
///
/// # Errors
/// An error of the output if the folder cannot be made or written; before the run where that can be known.
pub fn run(arguments: &Arguments) -> Result<(), OutputError> {
    let output = Output::create(&arguments.out, "report.json")?;
    let scene = arguments.scene();
    let mut app = app(scene.clone(), arguments.threads);
    #[cfg(feature = "render")]
    if arguments.frames {
        app.add_plugins(crate::cannon_demo::frame_capture::FrameCapturePlugin);
    }
    let progress = progress_bar(&scene);
    run_to_rest(&mut app, &scene, |time| progress.set((time * 10.0) as u64));
    progress.finish();
    let recorder = app.world_mut().remove_resource::<Recorder>().unwrap_or_default();
    match recorder.report(app.world_mut(), arguments.threads) {
        Some(report) => output.write(&report, &recorder)?,
        None => return Err(OutputError::NoCurtain),
    }
    if arguments.frames {
        draw_frames(&mut app, &scene, &arguments.out);
    }
    Ok(())
}

/// Draws the pictures after the run. Prints one line if there is no graphics adapter.
#[cfg(feature = "render")]
fn draw_frames(app: &mut App, scene: &CannonScene, folder: &Path) {
    use crate::cannon_demo::frame_capture::{CapturedFrames, capture_last};
    use crate::cannon_demo::frames;

    let is_over = app.world_mut().run_system_cached(capture_last).is_ok();
    let captured = app.world_mut().remove_resource::<CapturedFrames>().filter(|_| is_over);
    let frames = captured.unwrap_or_default().frames;
    let drawn = frames::draw(&frames, scene, folder, |path| println!("{}", path.display()));
    if let Err(error) = drawn {
        println!("no pictures: {error}");
    }
}

/// Prints the reason why there are no pictures.
#[cfg(not(feature = "render"))]
fn draw_frames(_: &mut App, _: &CannonScene, _: &Path) {
    println!("no pictures: this program was built without the feature `render`");
}

/// Steps until every shot is fired and all is at rest, or patience ends. Calls `on_step` with the time.
pub fn run_to_rest(app: &mut App, scene: &CannonScene, mut on_step: impl FnMut(f64)) {
    app.finish();
    app.cleanup();
    app.update();
    loop {
        let start = Instant::now();
        app.update();
        let wall = start.elapsed();
        let world = app.world_mut();
        world.resource_mut::<Recorder>().note_wall_time(wall);
        let time = world.resource::<DrapeClock>().elapsed();
        on_step(time);
        if is_over(world, scene) {
            return;
        }
    }
}

/// True if every shot is fired and all is at rest, or patience ends.
pub fn is_over(world: &World, scene: &CannonScene) -> bool {
    let time = world.resource::<DrapeClock>().elapsed();
    let recorder = world.resource::<Recorder>();
    let is_at_rest = world.resource::<ActivityCounts>().active == 0;
    !recorder.is_waiting(scene, time) && (is_at_rest || time - recorder.last_hit() > PATIENCE)
}

fn progress_bar(scene: &CannonScene) -> Progress {
    let last_shot = FIRST_SHOT + SHOT_INTERVAL * f64::from(scene.shots.saturating_sub(1));
    // Tenths of a second; how long the rest takes after the last shot is a guess.
    Progress::new("simulating", ((last_shot + 10.0) * 10.0) as u64, "tenths of a second")
}
