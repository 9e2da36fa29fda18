//! The time to quality: what a step costs and how far it lets a sheet stretch, and a plot of both.

use std::path::Path;

use plotters::prelude::*;
use serde::Serialize;

use crate::report::plot::range;

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
        let own: Vec<&Trial> = trials.iter().filter(|trial| trial.n == n).collect();
        let stretches = range(own.iter().map(|trial| trial.rms * 100.0), 1.5);
        let costs = range(own.iter().map(|trial| trial.ms), 1.5);
        let mut chart = ChartBuilder::on(area)
            .caption(format!("{n} x {n}"), ("sans-serif", 18))
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(56)
            .build_cartesian_2d(stretches.log_scale(), costs.log_scale())?;
        chart
            .configure_mesh()
            .x_desc("stretch in motion (root mean square, %)")
            .y_desc("ms a step")
            .light_line_style(WHITE)
            .draw()?;
        let mut curves: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
        for trial in own {
            let lines = if trial.lines { ", lines" } else { "" };
            let name = format!("{}{lines}, {}", trial.solver, trial.pins);
            let point = (trial.rms * 100.0, trial.ms);
            if !(point.0 > 0.0 && point.0.is_finite()) {
                continue;
            }
            match curves.iter_mut().find(|curve| curve.0 == name) {
                Some((_, curve)) => curve.push(point),
                None => curves.push((name, vec![point])),
            }
        }
        for (index, (name, points)) in curves.into_iter().enumerate() {
            let colour = Palette99::pick(index).to_rgba();
            chart
                .draw_series(LineSeries::new(points, colour.stroke_width(2)).point_size(3))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerLeft)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
    }
    root.present()?;
    Ok(())
}
