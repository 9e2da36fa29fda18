//! The greatest strain of structural sticks, which decides when relaxation may stop, and those that are stretched too far.
//!
//! Design: `docs/design/relaxation.md`.

use crate::simd::columns::{Cell, LANES};
use crate::state::body::Body;
use crate::state::grid::GridRun;
use crate::state::topology::{BatchSticks, LooseStick, StickBatch, StickBound, StickKind};

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

    fn strain(self) -> f32 {
        (self.greatest.sqrt() - 1.0).max(1.0 - self.least.sqrt())
    }
}

/// The greatest strain `|length / rest length - 1|` of the structural sticks that are relaxed, with this factor on rest lengths; sticks with
/// a bound count only where it acts.
pub(crate) fn greatest_strain(body: &Body, length_ratio: f32) -> f32 {
    lengths(body, length_ratio).strain()
}

/// Adds the numbers of the structural sticks of a batch that are relaxed and stretched by more than `strain`, but for those that only keep
/// their ends apart.
pub(crate) fn add_stretched(body: &Body, batch: &StickBatch, strain: f32, stretched: &mut Vec<usize>) {
    let Body { particles, topology, .. } = body;
    if !counts(batch) || batch.material.bound == StickBound::AtLeast {
        return;
    }
    let BatchSticks::Grid { batch: grid, runs, rest_length, severed } = &batch.sticks else {
        stretched.extend(batch.range().filter(|&i| {
            let [p, q] = topology.stick_slots(i).map(|slot| particles.position.get(slot));
            p.distance(q) / topology.rest_length(i) - 1.0 > strain
        }));
        return;
    };
    let (scale, most) = (1.0 / (rest_length * rest_length), (1.0 + strain) * (1.0 + strain));
    let (cells_of_strip, strips) = topology.layout.strips();
    for (band, runs) in runs.bands() {
        for strip in band.among(&(0..strips)) {
            let first = strip * cells_of_strip;
            for run in runs {
                for k in 0..run.count {
                    let squared = squared_lengths(&particles.position.cells[first..], run, k, scale);
                    if squared.iter().copied().fold(0.0, f32::max) <= most {
                        continue;
                    }
                    for lane in (0..LANES).filter(|&lane| squared[lane] > most) {
                        let slot =
                            |cell: u32, lane: usize| (first + (cell + k * run.step) as usize) * LANES + lane;
                        let ends = [slot(run.a, lane), slot(run.b, lane + usize::from(run.shift))];
                        let place = grid.stick_between(ends);
                        stretched.extend(place.and_then(|place| batch.number_of(place, severed)));
                    }
                }
            }
        }
    }
}

/// True if the sticks of a batch count: if they are structural and relaxed.
fn counts(batch: &StickBatch) -> bool {
    batch.material.kind == StickKind::Structural && batch.material.stiffness != 0.0
}

fn lengths(body: &Body, length_ratio: f32) -> Lengths {
    let Body { particles, topology, .. } = body;
    let mut lengths = Lengths { least: 1.0, greatest: 1.0 };
    for batch in &topology.batches {
        if !counts(batch) {
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

/// Measures the sticks of a run.
fn measure_run(cells: &[Cell], run: &GridRun, scale: f32, lengths: &mut Lengths) {
    for k in 0..run.count {
        squared_lengths(cells, run, k, scale).into_iter().for_each(|squared| lengths.take(squared));
    }
}

/// The squared lengths of the sticks of step `k` of a run, times `scale`; lanes without a stick count as a stick at rest.
#[inline]
fn squared_lengths(cells: &[Cell], run: &GridRun, k: u32, scale: f32) -> [f32; LANES] {
    let shift = usize::from(run.shift);
    let [a, b] = [run.a, run.b].map(|cell| &cells[(cell + k * run.step) as usize]);
    let mut lengths = [1.0; LANES];
    for (lane, length) in lengths.iter_mut().enumerate().take(LANES - shift) {
        let delta =
            [b.x[lane + shift] - a.x[lane], b.y[lane + shift] - a.y[lane], b.z[lane + shift] - a.z[lane]];
        let squared = (delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2]) * scale;
        if run.lanes & (1 << lane) != 0 {
            *length = squared;
        }
    }
    lengths
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
    /// Grids of every size, whole and torn.
    #[test]
    fn the_sticks_that_are_stretched_too_far_are_those_that_measuring_each_finds() {
        let sizes = [(5, 5), (20, 17), (4, 60), (64, 50)].into_iter().take(unless_miri(4, 2));
        for ((columns, rows), is_torn) in sizes.flat_map(|size| [(size, false), (size, true)]) {
            let cloth = ClothBuilder::new(1.0, 1.0, columns, rows);
            let mut body = cloth.build(BodySettings::default()).expect("valid");
            if is_torn {
                let blade =
                    [Vec3::new(-9.0, -0.4, -9.0), Vec3::new(0.6, -0.4, -9.0), Vec3::new(0.6, -0.5, 9.0)];
                body.cut(&[blade]).expect("can be cut").expect("is cut");
            }
            for i in 0..body.particles.len() {
                let offset = Vec3::new(libm::sinf(i as f32), libm::sinf(i as f32 * 1.7), 0.0) * 1e-2;
                body.particles.set_position(i, body.particles.position(i) + offset);
            }
            body.particles.arrange(&body.topology.layout);
            let strain = 0.02;
            let (mut found, mut expected) = (Vec::new(), Vec::new());
            for batch in &body.topology.batches {
                add_stretched(&body, batch, strain, &mut found);
                let is_structural = batch.material.kind == StickKind::Structural;
                let sticks = batch.range().filter(|_| is_structural).map(|i| (i, body.torn_stick(i)));
                expected.extend(
                    sticks
                        .filter(|(_, stick)| stick.length / stick.rest_length > 1.0 + strain)
                        .map(|(i, _)| i),
                );
            }
            found.sort_unstable();
            assert!(!found.is_empty() && found.len() < body.topology.stick_count() / 2);
            assert_eq!(found, expected, "{columns} x {rows}, torn: {is_torn}");
        }
    }
}
