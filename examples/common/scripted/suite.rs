//! Scenes without a window, one after another, and their verdict.

use core::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use bevy::ecs::message::{MessageCursor, Messages};
use bevy::prelude::{Fixed, Time, World};
use bevy_drape_script::checkpoint::{Checkpoint, CheckpointError};
use bevy_drape_script::play::CheckpointTaken;
use bevy_drape_script::recording::{Header, RecordSteps, RecordingError};
use bevy_drape_script::{Report, SceneError, SceneRunner, SceneScript, scene_name, to_junit};
use thiserror::Error;

use crate::progress::Progress;
use crate::scripted::arguments::{ReportFormat, SceneArguments};
#[cfg(feature = "render")]
use crate::scripted::pictures::PictureWriter;
use crate::scripted::plot::Curves;
#[cfg(feature = "render")]
use crate::view::offscreen::PictureError;

/// The errors of a run of scenes.
#[derive(Debug, Error)]
pub enum SuiteError {
    /// A folder cannot be made.
    #[error("{}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A folder cannot be read, or has no scenes in it.
    #[error(transparent)]
    NoScenes(SceneError),
    /// A recording cannot be written.
    #[error("{}: {source}", path.display())]
    Recording {
        /// The recording.
        path: PathBuf,
        /// The fault.
        source: RecordingError,
    },
    /// A plot cannot be drawn.
    #[error("{}: {reason}", path.display())]
    Plot {
        /// The plot.
        path: PathBuf,
        /// The fault.
        reason: String,
    },
    /// Pictures are asked for, and cannot be drawn.
    #[cfg(feature = "render")]
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Pictures are asked for, and this program draws none.
    #[cfg(not(feature = "render"))]
    #[error("`--frames` draws pictures, which needs the feature `render`: cargo run --features render ..")]
    CannotDraw,
    /// A checkpoint cannot be written, read or resumed.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The reports cannot be written.
    #[error("cannot write the report: {0}")]
    Report(String),
}

/// Runs all scenes, and returns whether all have passed.
///
/// # Errors
/// [`SuiteError`] if scenes are not found, or a file cannot be written. A scene that cannot be loaded has failed.
pub fn run(arguments: &SceneArguments) -> Result<bool, SuiteError> {
    let files = files_of(&arguments.files)?;
    make_folders(arguments, files.len())?;
    let mut reports = Vec::with_capacity(files.len());
    let mut pictures = Pictures::open(arguments.frames.as_deref())?;
    for file in &files {
        let report = run_scene(file, arguments, files.len(), &mut pictures)?;
        // The standard output may be for a program to read.
        if arguments.report.is_none() {
            tell(&report);
        } else {
            eprint!("{report}");
        }
        reports.push(report);
    }
    let passed = reports.iter().filter(|report| report.passed()).count();
    if reports.len() > 1 {
        eprintln!("{} scenes, {passed} passed, {} failed", reports.len(), reports.len() - passed);
        for report in reports.iter().filter(|report| !report.passed()) {
            eprintln!("failed: {}", report.scene);
        }
    }
    write_reports(&reports, arguments.report)?;
    Ok(passed == reports.len())
}

/// Prints to the standard output. A pipe that was closed, as by `scene .. | head`, is no error.
pub(crate) fn tell(what: &impl Display) {
    let _ = write!(io::stdout(), "{what}");
}

/// The scene files among `named`, and those in its folders.
pub(crate) fn files_of(named: &[PathBuf]) -> Result<Vec<PathBuf>, SuiteError> {
    let mut files = Vec::new();
    for path in named {
        if path.is_dir() {
            files.extend(bevy_drape_script::scene_files(path).map_err(SuiteError::NoScenes)?);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

fn make_folders(arguments: &SceneArguments, count: usize) -> Result<(), SuiteError> {
    let of_recordings = arguments.record.as_deref().and_then(|record| match count {
        1 => record.parent().filter(|folder| !folder.as_os_str().is_empty()),
        _ => Some(record),
    });
    let of_plots = arguments.plot.then_some(&*arguments.out);
    let folders = [of_recordings, of_plots, arguments.frames.as_deref()];
    folders.into_iter().flatten().try_for_each(make_folder)
}

fn make_folder(folder: &Path) -> Result<(), SuiteError> {
    std::fs::create_dir_all(folder)
        .map_err(|source| SuiteError::Folder { path: folder.to_path_buf(), source })
}

fn run_scene(
    file: &Path,
    arguments: &SceneArguments,
    count: usize,
    pictures: &mut Pictures,
) -> Result<Report, SuiteError> {
    if file.extension().is_some_and(|extension| extension == "checkpoint") {
        let checkpoint = Checkpoint::load(file)?;
        let name = checkpoint.scene().to_string();
        return run_to_end(SceneRunner::resume(&checkpoint)?, &name, arguments, count, pictures);
    }
    let name = scene_name(file);
    let script = match SceneScript::load_with(file, &arguments.overrides) {
        Ok(script) => script,
        Err(error) => return Ok(Report::failed(name, Some(file.to_path_buf()), &error.to_string())),
    };
    run_to_end(pictures.runner(script).from_file(file), &name, arguments, count, pictures)
}

fn run_to_end(
    mut runner: SceneRunner,
    name: &str,
    arguments: &SceneArguments,
    count: usize,
    pictures: &mut Pictures,
) -> Result<Report, SuiteError> {
    let dt = runner.world().resource::<Time<Fixed>>().timestep().as_secs_f32();
    let recording = arguments.record.as_ref().map(|record| match count {
        1 => record.clone(),
        _ => record.join(name).with_extension("drape"),
    });
    let unrecorded = |source| SuiteError::Recording { path: recording.clone().unwrap_or_default(), source };
    if let Some(path) = &recording {
        let steps = RecordSteps::create(path, Header { scene: name.to_string(), dt }).map_err(unrecorded)?;
        steps.start(runner.app_mut());
        runner.note_recording(path);
    }
    let progress = Progress::new(name, runner.greatest_steps(), "steps");
    let mut steps = 0;
    let mut curves = arguments.plot.then(Curves::default);
    let mut checkpoints = Checkpoints::default();
    let mut goes_on = true;
    while goes_on {
        goes_on = runner.step();
        steps += 1;
        progress.set(steps);
        pictures.look(&mut runner, name)?;
        checkpoints.save(runner.world(), arguments, name)?;
        if let Some(curves) = &mut curves {
            curves.note(runner.world());
        }
    }
    progress.finish();
    RecordSteps::finish(runner.world_mut()).map_err(unrecorded)?;
    if let Some(curves) = curves {
        let path = arguments.out.join(name).with_extension("svg");
        curves.draw(&path, name).map_err(|reason| SuiteError::Plot { path: path.clone(), reason })?;
        eprintln!("{}", path.display());
    }
    let report = runner.report();
    pictures.close(runner);
    Ok(report)
}

/// Writes the checkpoints that a scene's timeline takes.
#[derive(Default)]
struct Checkpoints {
    taken: MessageCursor<CheckpointTaken>,
}

impl Checkpoints {
    fn save(&mut self, world: &World, arguments: &SceneArguments, scene: &str) -> Result<(), SuiteError> {
        for CheckpointTaken { name, checkpoint } in
            self.taken.read(world.resource::<Messages<CheckpointTaken>>())
        {
            make_folder(&arguments.out)?;
            let path = arguments.out.join(format!("{scene}.{name}.checkpoint"));
            checkpoint.clone().named(scene).save(&path)?;
            eprintln!("{}", path.display());
        }
        Ok(())
    }
}

/// Draws pictures of the scenes, if they are asked for.
struct Pictures {
    #[cfg(feature = "render")]
    writer: Option<PictureWriter>,
}

#[cfg(feature = "render")]
impl Pictures {
    fn open(folder: Option<&Path>) -> Result<Self, SuiteError> {
        Ok(Self { writer: folder.map(PictureWriter::open).transpose()? })
    }

    fn runner(&mut self, script: SceneScript) -> SceneRunner {
        match &mut self.writer {
            Some(writer) => writer.runner(script),
            None => SceneRunner::headless(script),
        }
    }

    fn look(&mut self, runner: &mut SceneRunner, name: &str) -> Result<(), SuiteError> {
        self.writer.as_mut().map_or(Ok(()), |writer| Ok(writer.look(runner, name)?))
    }

    fn close(&mut self, runner: SceneRunner) {
        if let Some(writer) = &mut self.writer {
            writer.close(runner);
        }
    }
}

#[cfg(not(feature = "render"))]
#[expect(clippy::needless_pass_by_ref_mut, reason = "as where there is something to draw with")]
impl Pictures {
    fn open(folder: Option<&Path>) -> Result<Self, SuiteError> {
        if folder.is_some() { Err(SuiteError::CannotDraw) } else { Ok(Self {}) }
    }

    fn runner(&mut self, script: SceneScript) -> SceneRunner {
        SceneRunner::headless(script)
    }

    fn look(&mut self, _: &mut SceneRunner, _: &str) -> Result<(), SuiteError> {
        Ok(())
    }

    fn close(&mut self, _: SceneRunner) {}
}

fn write_reports(reports: &[Report], format: Option<ReportFormat>) -> Result<(), SuiteError> {
    let text = match format {
        None => return Ok(()),
        Some(ReportFormat::Json) => {
            serde_json::to_string_pretty(reports).map_err(|error| SuiteError::Report(error.to_string()))?
        }
        Some(ReportFormat::Junit) => {
            to_junit("scenes", reports).map_err(|error| SuiteError::Report(error.to_string()))?
        }
    };
    writeln!(io::stdout(), "{text}").map_err(|error| SuiteError::Report(error.to_string()))
}
