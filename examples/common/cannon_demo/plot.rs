//! Draws the samples of the recorder.

use std::path::Path;

use plotters::prelude::*;

use crate::cannon_demo::recorder::{Recorder, Sample};

/// One curve of the plot: its caption, colour and value.
struct Curve {
    caption: &'static str,
    colour: RGBColor,
    value: fn(&Sample) -> f64,
}

const CURVES: [Curve; 4] = [
    Curve { caption: "ball speed (m/s)", colour: RGBColor(0, 90, 160), value: |sample| sample.ball_speed },
    Curve {
        caption: "kinetic energy of the curtain (J)",
        colour: RGBColor(200, 60, 30),
        value: |sample| sample.kinetic_energy,
    },
    Curve {
        caption: "greatest stretch of a structural stick (%)",
        colour: RGBColor(110, 60, 150),
        value: |sample| sample.max_stretch * 100.0,
    },
    Curve {
        caption: "deflection of the curtain (m)",
        colour: RGBColor(20, 130, 70),
        value: |sample| sample.deflection,
    },
];

/// Draws four panels over time, hits marked, as an SVG.
///
/// # Errors
/// The message of the drawing library or of the file system.
pub fn draw(path: &Path, recorder: &Recorder) -> Result<(), String> {
    try_draw(path, recorder).map_err(|error| error.to_string())
}

fn try_draw(path: &Path, recorder: &Recorder) -> Result<(), Box<dyn std::error::Error>> {
    let samples = recorder.samples();
    let end = samples.last().map_or(1.0, |sample| sample.time);
    let root = SVGBackend::new(path, (960, 1000)).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, curve) in root.split_evenly((CURVES.len(), 1)).iter().zip(&CURVES) {
        let top = samples.iter().map(curve.value).fold(1e-6, f64::max) * 1.05;
        let mut chart = ChartBuilder::on(area)
            .caption(curve.caption, ("sans-serif", 16))
            .margin(8)
            .x_label_area_size(24)
            .y_label_area_size(56)
            .build_cartesian_2d(0.0..end, 0.0..top)?;
        chart.configure_mesh().x_desc("time (s)").light_line_style(WHITE).draw()?;
        for hit in recorder.hit_times() {
            let line = [(hit, 0.0), (hit, top)];
            chart.draw_series(LineSeries::new(line, BLACK.mix(0.3)))?;
        }
        let points = samples.iter().map(|sample| (sample.time, (curve.value)(sample)));
        chart.draw_series(LineSeries::new(points, curve.colour))?;
    }
    root.present()?;
    Ok(())
}
