//! Damping: each stick loses a part of the speed at which its ends part. Momentum and all other speeds stay.
//!
//! ```text
//!   before   <--o=========o-->        after   <-o=========o->        part = 1 - exp(-damping h)
//! ```
//!
//! Sticks of grids go a cell at a time and [listed ones](super::listed_damping) eight at a time, loose ones by themselves; all do what
//! [`damped`] does. Sticks take their turns batch after batch, as in relaxation.
//!
//! Design: `docs/design/relaxation.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load, shifted_by};
use crate::state::grid::GridRun;
use crate::state::topology::{LooseStick, StickBound, StickMaterial};

/// Distance from its bound within which a stick is damped, in parts of its rest length.
pub(crate) const AT_BOUND: f32 = 1e-3;

/// The part of the speed along a stick that damping (1/s) removes in a substep of `substep` seconds.
pub(crate) fn substep_damping(material: &StickMaterial, substep: f32) -> f32 {
    -libm::expm1(-f64::from(material.damping) * f64::from(substep)) as f32
}

/// A stick as damping sees it.
#[derive(Clone, Copy)]
pub(crate) struct DampedStick {
    /// Metres.
    pub rest_length: f32,
    pub bound: StickBound,
    /// The part of the speed that is removed.
    pub part: f32,
}

impl DampedStick {
    /// True if the stick is so far from its bound that it does not act.
    fn is_slack(self, length_squared: f32) -> bool {
        let strain = || length_squared.sqrt() / self.rest_length - 1.0;
        match self.bound {
            StickBound::Exact => false,
            StickBound::AtLeast => strain() > AT_BOUND,
            StickBound::AtMost => strain() < -AT_BOUND,
        }
    }
}

/// The displacements of the ends of one stick, damped: the reference for all kernels.
#[inline(always)]
pub(crate) fn damped(
    [p, q]: [Vec3; 2],
    [of_p, of_q]: [Vec3; 2],
    [wp, wq]: [f32; 2],
    stick: DampedStick,
) -> [Vec3; 2] {
    let delta = q - p;
    let length_squared = delta.length_squared();
    let divisor = length_squared * (wp + wq);
    if divisor > 0.0 && !stick.is_slack(length_squared) {
        let scale = stick.part * (of_q - of_p).dot(delta) / divisor;
        [of_p + delta * (wp * scale), of_q - delta * (wq * scale)]
    } else {
        [of_p, of_q]
    }
}

/// The columns of some cells that damping reads and writes.
pub(crate) struct DampedColumns<'a> {
    pub position: &'a [Cell],
    pub displacement: &'a mut [Cell],
    pub inverse_mass: &'a [[f32; LANES]],
}

impl DampedColumns<'_> {
    /// Damps the sticks of a grid in the strips that begin at `first_cells`: lane `l` of one cell against lane `l + shift` of another.
    /// None of a grid acts at one side only.
    #[inline(always)]
    pub fn damp_run<S: Simd>(
        &mut self,
        simd: S,
        run: &GridRun,
        first_cells: impl Iterator<Item = usize>,
        part: f32,
    ) {
        let Self { position, displacement, inverse_mass } = self;
        let shift = usize::from(run.shift);
        let lanes = mask32x16::from_bitmask(simd, u64::from(run.lanes));
        let zero = f32x16::splat(simd, 0.0);
        for first_cell in first_cells {
            let (mut a, mut b) = (first_cell + run.a as usize, first_cell + run.b as usize);
            for _ in 0..run.count {
                let Ok([of_a, of_b]) = displacement.get_disjoint_mut([a, b]) else { return };
                let (p, q) = (Lanes3::load(simd, &position[a]), Lanes3::load(simd, &position[b]));
                let (of_p, of_q) = (Lanes3::load(simd, of_a), Lanes3::load(simd, of_b));
                let wp = load(simd, &inverse_mass[a]);
                let wq = shifted_by(load(simd, &inverse_mass[b]), shift);
                let delta = q.shifted_by(shift).minus(p);
                let divisor = delta.dot(delta) * (wp + wq);
                let parting = of_q.shifted_by(shift).minus(of_p).dot(delta);
                let is_damped = lanes & divisor.simd_gt(zero);
                let scale = is_damped.select(parting * part / divisor, zero);
                of_p.plus(delta.times(wp * scale)).store(of_a);
                let back = (LANES - shift) % LANES;
                of_q.minus(delta.times(wq * scale).shifted_by(back)).store(of_b);
                a += run.step as usize;
                b += run.step as usize;
            }
        }
    }

    /// Damps sticks that belong to no run, one by one. Their ends may be anywhere, so the columns hold the whole body.
    pub fn damp_loose(&mut self, sticks: &[LooseStick], part: f32, bound: StickBound) {
        for &LooseStick { slots, rest_length } in sticks {
            let [[a, i], [b, j]] = slots.map(|slot| [slot as usize / LANES, slot as usize % LANES]);
            let ends = [self.position[a].get(i), self.position[b].get(j)];
            let displacements = [self.displacement[a].get(i), self.displacement[b].get(j)];
            let masses = [self.inverse_mass[a][i], self.inverse_mass[b][j]];
            let [p, q] = damped(ends, displacements, masses, DampedStick { rest_length, bound, part });
            self.displacement[a].set(i, p);
            self.displacement[b].set(j, q);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::testing::dice;
    use crate::simd::isa::{Isa, Kernel};
    use crate::state::topology::StickKind;

    /// S13: the speed along a stick decays as exp(-damping t); momentum and sideways speed stay.
    #[test]
    fn damping_takes_the_speed_along_the_stick_only() {
        let material = StickMaterial { damping: 2.0, ..StickMaterial::rigid(StickKind::Bend) };
        let part = substep_damping(&material, 0.5);
        let stick = DampedStick { rest_length: 1.0, bound: StickBound::Exact, part };
        let moved = [Vec3::NEG_X, Vec3::new(1.0, 3.0, 0.0)];
        for masses in [[1.0, 1.0], [1.0, 3.0]] {
            let [a, b] = damped([Vec3::ZERO, Vec3::X], moved, masses, stick);
            assert!(((b - a).x - 2.0 * libm::expf(-1.0)).abs() < 1e-5);
            assert!(((b - a).y - 3.0).abs() < 1e-6);
            let momentum = |[a, b]: [Vec3; 2]| a / masses[0] + b / masses[1];
            assert!((momentum([a, b]) - momentum(moved)).length() < 1e-5);
        }
    }

    struct DampRun<'a, 'b>(DampedColumns<'a>, &'b GridRun);

    impl Kernel for DampRun<'_, '_> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(mut self, simd: S) {
            self.0.damp_run(simd, self.1, 0..1, 0.3);
        }
    }

    /// The kernel for cells must damp every stick as the formula for one does, to the last bit.
    #[test]
    fn cells_and_single_sticks_are_damped_to_the_same_bits() {
        let mut dice = dice(3);
        let mut cells = || {
            let mut cells = [Cell::default(); 4];
            (0..4 * LANES).for_each(|slot| {
                cells[slot / LANES].set(slot % LANES, Vec3::new(dice(), dice(), dice()));
            });
            cells
        };
        let (mut position, start) = (cells(), cells());
        // Ends in one place, which have no direction; and pins.
        position[2] = position[0];
        let masses: Vec<[f32; LANES]> = (0..4)
            .map(|cell| {
                core::array::from_fn(|lane| if (cell + lane) % 3 == 0 { 0.0 } else { 1.0 + lane as f32 })
            })
            .collect();
        for isa in Isa::available() {
            for (shift, lanes) in
                [(0, u16::MAX), (0, 0x0ff3), (1, 0x7fff), (3, 0x1fff), (4, 0x0fff), (5, 0x07ff)]
            {
                let run = GridRun { a: 0, b: 2, count: 2, step: 1, shift, lanes };
                let (mut whole, mut single) = (start, start);
                let columns =
                    DampedColumns { position: &position, displacement: &mut whole, inverse_mass: &masses };
                isa.run(DampRun(columns, &run));
                for a in (0..2 * LANES).filter(|a| lanes & (1 << (a % LANES)) != 0) {
                    let ends =
                        [a, a + 2 * LANES + usize::from(shift)].map(|slot| (slot / LANES, slot % LANES));
                    let stick = DampedStick { rest_length: 1.0, bound: StickBound::Exact, part: 0.3 };
                    let moved = damped(
                        ends.map(|(cell, lane)| position[cell].get(lane)),
                        ends.map(|(cell, lane)| single[cell].get(lane)),
                        ends.map(|(cell, lane)| masses[cell][lane]),
                        stick,
                    );
                    for ((cell, lane), place) in ends.into_iter().zip(moved) {
                        single[cell].set(lane, place);
                    }
                }
                assert_eq!(whole, single, "shift {shift} on {}", isa.name());
                assert_ne!(whole, start);
            }
        }
    }
}
