//! Plots of cost and stretch by size.

use std::path::Path;

use plotters::coord::Shift;
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
    for (area, panel) in root.split_evenly((PANELS.len(), 1)).iter().zip(&PANELS) {
        let point = |outcome: &Outcome| {
            let threads = if outcome.threads > 1 { format!(" x {}", outcome.threads) } else { String::new() };
            let name = format!("{} {}{threads}", outcome.scene, outcome.solver);
            (name, (f64::from(outcome.n), (panel.value)(outcome)))
        };
        Chart {
            caption: panel.caption,
            axes: ["size n", ""],
            margins: [1.2, 2.0],
            legend: SeriesLabelPosition::MiddleRight,
        }
        .draw(area, outcomes.iter().map(point))?;
    }
    root.present()?;
    Ok(())
}

/// A chart whose axes are logarithmic.
pub(super) struct Chart<'a> {
    pub caption: &'a str,
    /// Descriptions of both axes; none if empty.
    pub axes: [&'a str; 2],
    /// Factors by which the axes are wider than the points, at both ends.
    pub margins: [f64; 2],
    pub legend: SeriesLabelPosition,
}

impl Chart<'_> {
    /// Draws points, each with the name of its curve. Those that a logarithm cannot show are left out.
    pub fn draw(
        self,
        area: &DrawingArea<SVGBackend, Shift>,
        points: impl Iterator<Item = (String, (f64, f64))>,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let Self { caption, axes: [x_axis, y_axis], margins, legend } = self;
        let curves = curves(points);
        let all = || curves.iter().flat_map(|(_, points)| points);
        let across = range(all().map(|point| point.0), margins[0]);
        let up = range(all().map(|point| point.1), margins[1]);
        let mut chart = ChartBuilder::on(area)
            .caption(caption, ("sans-serif", 18))
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(64)
            .build_cartesian_2d(across.log_scale(), up.log_scale())?;
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(x_axis).light_line_style(WHITE);
        if !y_axis.is_empty() {
            mesh.y_desc(y_axis);
        }
        mesh.draw()?;
        for (index, (name, points)) in curves.iter().enumerate() {
            let colour = Palette99::pick(index).to_rgba();
            let shown = points.iter().copied().filter(|&(x, y)| is_shown(x) && is_shown(y));
            chart
                .draw_series(LineSeries::new(shown, colour.stroke_width(2)).point_size(3))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .position(legend)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        Ok(())
    }
}

/// A curve: its name and its points.
type Curve = (String, Vec<(f64, f64)>);

/// Puts points together that belong to one curve, in the order in which they come.
fn curves(points: impl Iterator<Item = (String, (f64, f64))>) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for (name, point) in points {
        match curves.iter_mut().find(|curve| curve.0 == name) {
            Some((_, curve)) => curve.push(point),
            None => curves.push((name, vec![point])),
        }
    }
    curves
}

/// True if a logarithm can show it.
fn is_shown(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

/// From the least to the greatest of what a logarithm can show, wider by `margin` at both ends.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> std::ops::Range<f64> {
    let shown = values.filter(|&value| is_shown(value));
    let (least, greatest) =
        shown.fold((f64::MAX, 0.0), |(low, high), value| (f64::min(low, value), f64::max(high, value)));
    if greatest > 0.0 { least / margin..greatest * margin } else { 0.1..1.0 }
}
