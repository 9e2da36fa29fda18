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

/// The numbers of these sticks that are stretched by more than `strain`, but for those that only keep their ends apart.
pub(crate) fn stretched_sticks(body: &Body, strain: f32) -> Vec<usize> {
    let mut stretched = Vec::new();
    if greatest_stretch(body) <= strain {
        return stretched;
    }
    let Body { particles, topology, .. } = body;
    let most = (1.0 + strain) * (1.0 + strain);
    for batch in topology.batches.iter().filter(|batch| is_measured(batch)) {
        let BatchSticks::Grid { batch: grid, runs, rest_length, severed } = &batch.sticks else {
            let has_length = batch.material.bound != StickBound::AtLeast;
            stretched.extend(batch.range().filter(|&i| {
                let [p, q] = topology.stick_slots(i).map(|slot| particles.position.get(slot));
                has_length && p.distance(q) / topology.rest_length(i) - 1.0 > strain
            }));
            continue;
        };
        let scale = 1.0 / (rest_length * rest_length);
        for (first, runs) in topology.layout.runs_by_strip(runs) {
            let cells = &particles.position.cells[first..];
            for run in runs.iter().filter(|run| is_stretched(cells, run, most / scale)) {
                let far = run.slots(first).filter(|&ends| {
                    let [p, q] = ends.map(|slot| particles.position.get(slot));
                    p.distance_squared(q) * scale > most
                });
                let places = far.filter_map(|ends| grid.stick_between(ends));
                stretched.extend(places.filter_map(|place| batch.number_of(place, severed)));
            }
        }
    }
    stretched
}

/// True if some places that the sticks of a run may join are farther apart than the root of `most`, less a rounding error.
fn is_stretched(cells: &[Cell], run: &GridRun, most: f32) -> bool {
    let shift = usize::from(run.shift);
    let mut greatest = [0.0_f32; LANES];
    for k in 0..run.count {
        let [a, b] = [run.a, run.b].map(|cell| &cells[(cell + k * run.step) as usize]);
        for (lane, greatest) in greatest.iter_mut().enumerate().take(LANES - shift) {
            let delta =
                [b.x[lane + shift] - a.x[lane], b.y[lane + shift] - a.y[lane], b.z[lane + shift] - a.z[lane]];
            *greatest = greatest.max(delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2]);
        }
    }
    greatest.iter().any(|&greatest| greatest > most * (1.0 - ROUNDING))
}

/// The most by which a squared length is wrong, in parts of it.
const ROUNDING: f32 = 1e-5;

/// True for batches of structural sticks that are relaxed.
fn is_measured(batch: &StickBatch) -> bool {
    batch.material.kind == StickKind::Structural && batch.material.stiffness != 0.0
}

fn lengths(body: &Body, length_ratio: f32) -> Lengths {
    let Body { particles, topology, .. } = body;
    let mut lengths = Lengths { least: 1.0, greatest: 1.0 };
    for batch in &topology.batches {
        if !is_measured(batch) {
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

    /// Grids of every size, whole and cut.
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
            let (mut found, mut expected) = (stretched_sticks(&body, strain), Vec::new());
            for batch in &body.topology.batches {
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
