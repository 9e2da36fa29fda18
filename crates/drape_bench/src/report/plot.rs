//! Plots of cost and stretch by size.

use std::path::Path;

use plotters::prelude::*;

use crate::report::outcome::Outcome;

/// A panel: its caption and its value.
struct Panel {
    caption: &'static str,
    value: fn(&Outcome) -> f64,
}

const PANELS: [Panel; 2] = [
    Panel { caption: "cost (ns per stick and sweep)", value: |outcome| outcome.ns_per_stick_sweep },
    Panel {
        caption: "stretch in motion (root mean square, %)",
        value: |outcome| outcome.stretch_rms_motion * 100.0,
    },
];

/// Draws cost and stretch over the size of the scene, a curve for each scene, solver and number of threads; all
/// axes are logarithmic.
///
/// # Errors
/// The error of the drawing library or the file system.
pub fn draw(path: &Path, outcomes: &[Outcome]) -> Result<(), String> {
    try_draw(path, outcomes).map_err(|error| format!("cannot draw {}: {error}", path.display()))
}

fn try_draw(path: &Path, outcomes: &[Outcome]) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::new(path, (960, 960)).into_drawing_area();
    root.fill(&WHITE)?;
    let curves = curves(outcomes);
    for (area, panel) in root.split_evenly((PANELS.len(), 1)).iter().zip(&PANELS) {
        let sizes = range(outcomes.iter().map(|outcome| f64::from(outcome.n)), 1.2);
        let values = range(outcomes.iter().map(panel.value), 2.0);
        let mut chart = ChartBuilder::on(area)
            .caption(panel.caption, ("sans-serif", 18))
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(64)
            .build_cartesian_2d(sizes.log_scale(), values.log_scale())?;
        chart.configure_mesh().x_desc("size n").light_line_style(WHITE).draw()?;
        for (index, (name, curve)) in curves.iter().enumerate() {
            let colour = Palette99::pick(index).to_rgba();
            let points = curve.iter().map(|outcome| (f64::from(outcome.n), (panel.value)(outcome)));
            let points: Vec<_> = points.filter(|point| point.1 > 0.0 && point.1.is_finite()).collect();
            chart
                .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(3))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
    }
    root.present()?;
    Ok(())
}

/// The lines that belong to one curve, by name, in the order of the table.
fn curves(outcomes: &[Outcome]) -> Vec<(String, Vec<&Outcome>)> {
    let mut curves: Vec<(String, Vec<&Outcome>)> = Vec::new();
    for outcome in outcomes {
        let threads = if outcome.threads > 1 { format!(" x {}", outcome.threads) } else { String::new() };
        let name = format!("{} {}{threads}", outcome.scene, outcome.solver);
        match curves.iter_mut().find(|curve| curve.0 == name) {
            Some((_, curve)) => curve.push(outcome),
            None => curves.push((name, vec![outcome])),
        }
    }
    curves
}

/// From the least to the greatest of what a logarithm can show, wider by `margin` at both ends.
pub(super) fn range(values: impl Iterator<Item = f64>, margin: f64) -> std::ops::Range<f64> {
    let shown = values.filter(|value| *value > 0.0 && value.is_finite());
    let (least, greatest) =
        shown.fold((f64::MAX, 0.0), |(low, high), value| (f64::min(low, value), f64::max(high, value)));
    if greatest > 0.0 { least / margin..greatest * margin } else { 0.1..1.0 }
}
