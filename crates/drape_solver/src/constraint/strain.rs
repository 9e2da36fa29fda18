//! The greatest strain of structural sticks, which decides when relaxation may stop.
//!
//! Design: `docs/design/relaxation.md`.

use crate::simd::columns::{Cell, LANES};
use crate::state::body::Body;
use crate::state::grid::GridRun;
use crate::state::topology::{BatchSticks, LooseStick, StickBound, StickKind};

/// The least and the greatest squared length of some sticks, in parts of their squared rest length.
#[derive(Clone, Copy)]
struct Lengths {
    least: f32,
    greatest: f32,
}

impl Lengths {
    fn take(&mut self, squared: f32) {
        self.least = self.least.min(squared);
        self.greatest = self.greatest.max(squared);
    }

    /// Adds the squared length of a stick that may have a bound: it counts only where the bound acts.
    fn take_bounded(&mut self, squared: f32, bound: StickBound) {
        match bound {
            StickBound::Exact => self.take(squared),
            StickBound::AtLeast => self.take(squared.min(1.0)),
            StickBound::AtMost => self.take(squared.max(1.0)),
        }
    }

    fn stretch(self) -> f32 {
        self.greatest.sqrt() - 1.0
    }

    fn strain(self) -> f32 {
        self.stretch().max(1.0 - self.least.sqrt())
    }
}

/// The greatest strain `|length / rest length - 1|` of the structural sticks that are relaxed, with this factor on rest lengths; sticks with
/// a bound count only where it acts.
pub(crate) fn greatest_strain(body: &Body, length_ratio: f32) -> f32 {
    lengths(body, length_ratio).strain()
}

/// The greatest stretch of these sticks beyond their rest length, in parts of it.
pub(crate) fn greatest_stretch(body: &Body) -> f32 {
    lengths(body, 1.0).stretch()
}

fn lengths(body: &Body, length_ratio: f32) -> Lengths {
    let Body { particles, topology, .. } = body;
    let mut lengths = Lengths { least: 1.0, greatest: 1.0 };
    for batch in &topology.batches {
        if batch.material.kind != StickKind::Structural || batch.material.stiffness == 0.0 {
            continue;
        }
        match &batch.sticks {
            BatchSticks::Grid { runs, rest_length, .. } => {
                let rest_length = rest_length * length_ratio;
                let scale = 1.0 / (rest_length * rest_length);
                let (cells_of_strip, strips) = topology.layout.strips();
                for (band, runs) in runs.bands() {
                    for strip in band.among(&(0..strips)) {
                        let cells = &particles.position.cells[strip * cells_of_strip..];
                        runs.iter().for_each(|run| measure_run(cells, run, scale, &mut lengths));
                    }
                }
            }
            BatchSticks::Listed(listed) => {
                for place in listed.first..listed.first + batch.count {
                    let [p, q] =
                        topology.listed.slots(place).map(|slot| particles.position.get(slot as usize));
                    let rest_length = topology.listed.rest_length(place) * length_ratio;
                    let squared = p.distance_squared(q) / (rest_length * rest_length);
                    lengths.take_bounded(squared, batch.material.bound);
                }
            }
            BatchSticks::Loose(loose) => {
                for LooseStick { slots, rest_length } in loose {
                    let [p, q] = slots.map(|slot| particles.position.get(slot as usize));
                    let squared = p.distance_squared(q) / (rest_length * rest_length);
                    lengths.take_bounded(squared, batch.material.bound);
                }
            }
        }
    }
    lengths
}

/// Measures the sticks of a run, lane by lane; lanes without a stick count as a stick at rest.
fn measure_run(cells: &[Cell], run: &GridRun, scale: f32, lengths: &mut Lengths) {
    let shift = usize::from(run.shift);
    let has_stick: [bool; LANES] = core::array::from_fn(|lane| run.lanes & (1 << lane) != 0);
    for k in 0..run.count {
        let [a, b] = [run.a, run.b].map(|cell| &cells[(cell + k * run.step) as usize]);
        for (lane, &has_stick) in has_stick.iter().enumerate().take(LANES - shift) {
            let delta =
                [b.x[lane + shift] - a.x[lane], b.y[lane + shift] - a.y[lane], b.z[lane + shift] - a.z[lane]];
            let squared = (delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2]) * scale;
            lengths.take(if has_stick { squared } else { 1.0 });
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::simd::miri::unless_miri;
    use crate::state::measure;
    use crate::state::settings::BodySettings;
    use crate::substep::testing::run_stages;

    /// Grids of every cut, and one that is too small to be cut.
    #[test]
    fn it_is_the_greatest_stretch_of_all_structural_sticks() {
        for (columns, rows) in [(5, 5), (20, 17), (4, 60), (64, 50)].into_iter().take(unless_miri(4, 2)) {
            let cloth = ClothBuilder::new(1.0, 1.0, columns, rows);
            let mut body = cloth.build(BodySettings::default()).expect("valid");
            for i in 0..body.particles.len() {
                let offset = Vec3::new(libm::sinf(i as f32), libm::sinf(i as f32 * 1.7), 0.0) * 1e-3;
                body.particles.set_position(i, body.particles.position(i) + offset);
            }
            run_stages(&mut body, 1e-2, &[]);
            let greatest = f64::from(greatest_strain(&body, 1.0));
            let expected = measure::stretch(&body.particles, &body.topology).max;
            assert!((greatest - expected).abs() < 1e-5 * expected, "{greatest}, expected {expected}");
        }
    }
}
