//! Draws how the bodies of a scene moved and stretched.

use std::collections::BTreeMap;
use std::path::Path;

// Not all of the prelude, whose `Color` clashes with that of the plots.
use bevy::prelude::World;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Sticks;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape_script::play::ScenePlay;
use drape_solver::state::measure;
use plotters::prelude::*;

/// One value of every body, by name, over time.
type Curve = BTreeMap<String, Vec<(f64, f64)>>;

/// Speed and stretch of the bodies of a scene.
#[derive(Default)]
pub struct Curves {
    speed: Curve,
    stretch: Curve,
}

impl Curves {
    /// Notes the state after a step.
    pub fn note(&mut self, world: &World) {
        let Some(play) = world.get_resource::<ScenePlay>() else { return };
        let time = world.resource::<DrapeClock>().elapsed();
        for (name, entity) in play.bodies(world) {
            if let Some(ball) = world.get::<ProjectileState>(entity) {
                let speed = f64::from(ball.velocity().length());
                self.speed.entry(name).or_default().push((time, speed));
            } else if let (Some(particles), Some(sticks)) =
                (world.get::<Particles>(entity), world.get::<Sticks>(entity))
            {
                let speed = f64::from(particles.mean_square_speed()).sqrt();
                let stretch = 100.0 * measure::stretch(particles, sticks).rms;
                self.speed.entry(name.clone()).or_default().push((time, speed));
                self.stretch.entry(name).or_default().push((time, stretch));
            }
        }
    }

    /// Draws two panels as an SVG.
    ///
    /// # Errors
    /// The message of the drawing library or of the file system.
    pub fn draw(&self, path: &Path, scene: &str) -> Result<(), String> {
        self.try_draw(path, scene).map_err(|error| error.to_string())
    }

    fn try_draw(&self, path: &Path, scene: &str) -> Result<(), Box<dyn std::error::Error>> {
        let root = SVGBackend::new(path, (960, 640)).into_drawing_area();
        root.fill(&WHITE)?;
        let panels = [
            (&self.speed, format!("{scene}: speed, root mean square (m/s)")),
            (&self.stretch, format!("{scene}: stretch of structural sticks, root mean square (%)")),
        ];
        for (area, (curve, caption)) in root.split_evenly((panels.len(), 1)).iter().zip(panels) {
            let all = || curve.values().flatten();
            let from = all().map(|&(time, _)| time).fold(f64::INFINITY, f64::min).min(1e9);
            let to = all().map(|&(time, _)| time).fold(from + 1e-3, f64::max);
            let top = all().map(|&(_, value)| value).fold(1e-6, f64::max) * 1.05;
            let mut chart = ChartBuilder::on(area)
                .caption(caption, ("sans-serif", 16))
                .margin(8)
                .x_label_area_size(24)
                .y_label_area_size(56)
                .build_cartesian_2d(from..to, 0.0..top)?;
            chart.configure_mesh().x_desc("time (s)").light_line_style(WHITE).draw()?;
            for (index, (name, points)) in curve.iter().enumerate() {
                let colour = Palette99::pick(index).to_rgba();
                let drawn = chart.draw_series(LineSeries::new(points.iter().copied(), colour))?;
                // More names than a legend has room for say nothing.
                if curve.len() <= 8 {
                    drawn.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour));
                }
            }
            chart.configure_series_labels().background_style(WHITE.mix(0.8)).draw()?;
        }
        root.present()?;
        Ok(())
    }
}
