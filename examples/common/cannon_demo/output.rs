//! The results of a run without a window: report, plot, and a table on the screen.

use std::path::{Path, PathBuf};
use std::{fs, io};

use comfy_table::{CellAlignment, Table, presets};
use thiserror::Error;

use crate::cannon_demo::plot;
use crate::cannon_demo::recorder::Recorder;
use crate::cannon_demo::report::Report;

/// Why the results could not be written.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The folder cannot be made.
    #[error("cannot make the output folder {path}: {source}")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error("cannot write {path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The plot cannot be drawn.
    #[error("cannot draw {path}: {reason}")]
    Plot {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The curtain could not be built; the log says why.
    #[error("there is no curtain to report on")]
    NoCurtain,
}

/// The folder that results go to.
pub struct Output {
    folder: PathBuf,
}

impl Output {
    /// Makes the folder and makes sure that `file` can be written there, before the long run.
    ///
    /// # Errors
    /// [`OutputError::Folder`] or [`OutputError::File`].
    pub fn create(folder: &Path, file: &str) -> Result<Self, OutputError> {
        let output = Self { folder: folder.to_path_buf() };
        fs::create_dir_all(folder)
            .map_err(|source| OutputError::Folder { path: output.folder.clone(), source })?;
        output.write_file(file, "")?;
        Ok(output)
    }

    /// Path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes `report.json` and `plot.svg`, and prints the table.
    ///
    /// # Errors
    /// [`OutputError`] naming the file.
    pub fn write(&self, report: &Report, recorder: &Recorder) -> Result<(), OutputError> {
        let json = serde_json::to_string_pretty(report)
            .map_err(|error| OutputError::File { path: self.path("report.json"), source: error.into() })?;
        self.write_file("report.json", &json)?;
        let path = self.path("plot.svg");
        plot::draw(&path, recorder).map_err(|reason| OutputError::Plot { path, reason })?;
        println!("{}", summary(report));
        println!("report and plot are in {}", self.folder.display());
        Ok(())
    }

    fn write_file(&self, name: &str, content: &str) -> Result<(), OutputError> {
        let path = self.path(name);
        fs::write(&path, content).map_err(|source| OutputError::File { path, source })
    }
}

/// The report as a person reads it.
fn summary(report: &Report) -> String {
    let mut shots = Table::new();
    shots.load_preset(presets::UTF8_HORIZONTAL_ONLY).set_header([
        "shot",
        "speed m/s",
        "elevation",
        "azimuth",
        "hit after s",
        "predicted",
        "ball before",
        "after m/s",
        "deflection m",
        "ball ends",
        "collision ms",
    ]);
    let some = |value: Option<f64>, digits: usize| value.map_or("-".to_owned(), |v| format!("{v:.digits$}"));
    for shot in &report.shots {
        shots.add_row([
            (shot.index + 1).to_string(),
            format!("{:.0}", shot.speed_m_s),
            format!("{:.2}°", shot.elevation_deg),
            format!("{:.2}°", shot.azimuth_deg),
            some(shot.hit_time_s, 3),
            format!("{:.3}", shot.predicted_hit_time_s),
            some(shot.ball_speed_before_m_s, 1),
            some(shot.ball_speed_after_m_s, 1),
            format!("{:.2}", shot.curtain_max_deflection_m),
            shot.ball_final_state.to_owned(),
            format!("{:.2}", shot.collision_ms),
        ]);
    }
    for column in shots.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let (scene, curtain, timing) = (&report.scene, &report.curtain, &report.timing);
    let hits = report.shots.iter().filter(|shot| shot.hit).count();
    format!(
        "{shots}\n\
         {hits} of {} shots hit; {} particles, {} sticks, {} substeps x {} iterations\n\
         curtain: at rest after {} s; stretch rms {:.3} %, max {:.2} %, peak {:.1} %; deepest penetration {:.2} mm\n\
         cost: {} steps, median {:.2} ms, 99 % under {:.2} ms, {:.1} x real time on {} threads\n\
         state hash {}",
        report.shots.len(),
        scene.particles,
        scene.sticks,
        scene.substeps,
        scene.iterations,
        some(curtain.rest_time_s, 1),
        curtain.rms_stretch * 100.0,
        curtain.max_stretch * 100.0,
        curtain.peak_stretch * 100.0,
        curtain.max_penetration_m * 1e3,
        timing.steps,
        timing.wall_ms_median,
        timing.wall_ms_p99,
        timing.realtime_factor,
        timing.threads,
        report.state_hash,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_cannot_be_written_is_a_clear_error() {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"));
        let error = Output::create(&file.join("out"), "report.json").err().expect("not a folder").to_string();
        assert!(error.contains("cannot make the output folder"), "{error}");
    }
}
