//! The time to quality: what a step costs and how far it lets a sheet stretch, and a plot of both.

use std::path::Path;

use plotters::prelude::*;
use serde::Serialize;

use crate::report::plot::Chart;

/// What one choice of settings costs, and how much it stretches.
#[derive(Clone, Debug, Serialize)]
pub struct Trial {
    /// The solver's name.
    pub solver: &'static str,
    /// Particles in a row of the sheet.
    pub n: u32,
    /// The pinned particles.
    pub pins: String,
    /// Stretch of the structural sticks in motion, root mean square.
    pub rms: f64,
    /// Milliseconds of a step.
    pub ms: f64,
    /// Substeps in a step, of one sweep.
    pub substeps: u32,
    /// True if this project's solver solves rows and columns directly.
    pub lines: bool,
}

/// Draws the cost of a step over the stretch that it leaves, a panel for each size and a curve for each solver and kind of pins; all
/// axes are logarithmic.
///
/// # Errors
/// The error of the drawing library or the file system.
pub fn draw(path: &Path, trials: &[Trial]) -> Result<(), String> {
    try_draw(path, trials).map_err(|error| format!("cannot draw {}: {error}", path.display()))
}

fn try_draw(path: &Path, trials: &[Trial]) -> Result<(), Box<dyn std::error::Error>> {
    let mut sizes: Vec<u32> = trials.iter().map(|trial| trial.n).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let rows = sizes.len().div_ceil(2);
    let root = SVGBackend::new(path, (960, 400 * rows as u32)).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, n) in root.split_evenly((rows, 2)).iter().zip(sizes) {
        let point = |trial: &Trial| {
            let lines = if trial.lines { ", lines" } else { "" };
            let name = format!("{}{lines}, {}", trial.solver, trial.pins);
            (name, (trial.rms * 100.0, trial.ms))
        };
        Chart {
            caption: &format!("{n} x {n}"),
            axes: ["stretch in motion (root mean square, %)", "ms a step"],
            margins: [1.5, 1.5],
            legend: SeriesLabelPosition::LowerLeft,
        }
        .draw(area, trials.iter().filter(|trial| trial.n == n).map(point))?;
    }
    root.present()?;
    Ok(())
}
