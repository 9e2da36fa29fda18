//! The damping of [listed sticks](crate::state::stick_list), in one sweep like their relaxation: positions are read in rows, and
//! displacements change in rows of their own.
//!
//! Design: `docs/design/listed_sticks.md`.

use fearless_simd::{Simd, f32x4, f32x8, prelude::*};

use crate::constraint::damping::{AT_BOUND, DampedStick, damped};
use crate::constraint::listed_stick::{
    BatchPass, BlockWork, ends_of_rows, finite, masses_of_eight, pairs, set_pair, sticks_of_block,
};
use crate::simd::columns::{Cell, LANES};
use crate::simd::rows::{Rows, Window, columns_of_rows, rows_of_columns};
use crate::state::stick_list::{ListedSticks, StickGroup};
use crate::state::topology::StickBound;

/// The damping of listed sticks: the columns and lists that it reads and writes.
pub(crate) struct Damping<'a> {
    /// Rows of positions, and of displacements.
    pub rows: &'a mut [Rows; 2],
    pub position: &'a [Cell],
    pub displacement: &'a mut [Cell],
    pub inverse_mass: &'a [[f32; LANES]],
    pub sticks: &'a ListedSticks,
}

/// Each part is a function of its own, because the compiler would take minutes for one function of all kernels.
impl BlockWork for Damping<'_> {
    fn take<S: Simd>(&mut self, simd: S, block: usize) {
        let [positions, displacements] = &mut *self.rows;
        simd.vectorize(
            #[inline(always)]
            || {
                positions.take(simd, block, self.position, self.inverse_mass);
                displacements.take(simd, block, self.displacement, self.inverse_mass);
            },
        );
    }

    fn pass<S: Simd>(&mut self, simd: S, pass: BatchPass, block: usize) {
        let BatchPass { batch, part, bound, length_ratio } = pass;
        let (groups, alone) = sticks_of_block(self.sticks, batch, block);
        let [positions, displacements] = &mut *self.rows;
        simd.vectorize(
            #[inline(always)]
            || {
                let mut windows = [positions.window(), displacements.window()];
                for group in groups {
                    damp_group(simd, &mut windows, group, pass);
                }
                for place in alone {
                    let rest_length = self.sticks.rest_length(place) * length_ratio;
                    let stick = DampedStick { rest_length, bound, part };
                    damp_row(simd, &mut windows, self.sticks.ends(place), stick);
                }
            },
        );
    }

    fn put_back<S: Simd>(&mut self, simd: S, block: usize) {
        simd.vectorize(
            #[inline(always)]
            || self.rows[1].put_back(simd, block, self.displacement),
        );
    }
}

/// One stick in rows.
#[inline(always)]
fn damp_row<S: Simd>(
    simd: S,
    [positions, displacements]: &mut [Window; 2],
    ends: [u32; 2],
    stick: DampedStick,
) {
    let [a, b] = ends.map(|first| positions.place(first));
    let (places, [wp, wq]) = ends_of_rows(simd, positions, [a, b]);
    let (moved, [of_p, of_q]) = ends_of_rows(simd, displacements, [a, b]);
    let [p, q] = damped(places, moved, [finite(wp), finite(wq)], stick);
    displacements.set(a, f32x4::load_array(simd, [p.x, p.y, p.z, of_p]));
    displacements.set(b, f32x4::load_array(simd, [q.x, q.y, q.z, of_q]));
}

/// Eight sticks that share no particle.
#[inline(always)]
fn damp_group<S: Simd>(
    simd: S,
    [positions, displacements]: &mut [Window; 2],
    group: &StickGroup,
    BatchPass { part, bound, length_ratio, .. }: BatchPass,
) {
    let [a, b] = group.ends.map(|ends| ends.map(|first| positions.place(first)));
    let zero = f32x8::splat(simd, 0.0);
    let (p, q) = (pairs(simd, positions, a), pairs(simd, positions, b));
    let (of_p, of_q) = (pairs(simd, displacements, a), pairs(simd, displacements, b));
    let [x, y, z, _] = columns_of_rows([q[0] - p[0], q[1] - p[1], q[2] - p[2], q[3] - p[3]]);
    let parting = [of_q[0] - of_p[0], of_q[1] - of_p[1], of_q[2] - of_p[2], of_q[3] - of_p[3]];
    let [u, v, w, _] = columns_of_rows(parting);
    let (wp, wq) = (masses_of_eight(simd, p), masses_of_eight(simd, q));
    let length_squared = x * x + y * y + z * z;
    let divisor = length_squared * (wp + wq);
    let rest = f32x8::load_array_ref(simd, &group.rest_lengths) * length_ratio;
    let strain = length_squared.sqrt() / rest - 1.0;
    let is_damped = divisor.simd_gt(zero)
        & match bound {
            StickBound::Exact => divisor.simd_gt(zero),
            StickBound::AtLeast => strain.simd_le(f32x8::splat(simd, AT_BOUND)),
            StickBound::AtMost => strain.simd_ge(f32x8::splat(simd, -AT_BOUND)),
        };
    let scale = is_damped.select((u * x + v * y + w * z) * part / divisor, zero);
    let (to_p, to_q) = (rows_of_columns([wp * scale; 4]), rows_of_columns([wq * scale; 4]));
    // The fourth numbers, inverse masses, do not matter in rows of displacements.
    let delta = rows_of_columns([x, y, z, zero]);
    for i in 0..4 {
        set_pair(displacements, a, i, of_p[i] + delta[i] * to_p[i]);
        set_pair(displacements, b, i, of_q[i] - delta[i] * to_q[i]);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::constraint::testing::{dice, listed_batches, places_of};
    use crate::simd::isa::{Isa, Kernel};
    use crate::simd::rows::BLOCK;
    use crate::state::stick_list::ListedBatch;

    struct Damp<'a, 'b>(Damping<'a>, &'b [BatchPass<'b>]);

    impl Kernel for Damp<'_, '_> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(mut self, simd: S) {
            let cells = self.0.position.len();
            self.0.descend(simd, cells, self.1.iter().copied());
        }
    }

    /// The sweep, eight sticks at a time and block after block, must damp as one stick after another does, batch after batch, to the
    /// last bit.
    #[test]
    #[cfg_attr(miri, ignore = "it takes more than three blocks of particles")]
    fn the_sweep_and_single_sticks_are_damped_to_the_same_bits() {
        let count = 3 * BLOCK + 77;
        let cells = count.div_ceil(LANES);
        let mut sticks = ListedSticks::default();
        let batches = listed_batches(&mut sticks, count as u32, &[1, 3, 40, 600, 2, 700]);
        let mut dice = dice(5);
        let mut columns = || -> Vec<Cell> {
            let mut columns = vec![Cell::default(); cells];
            // Half as far apart as the sticks are long, on average: some are slack, some taut.
            (0..count).for_each(|slot| {
                columns[slot / LANES].set(slot % LANES, Vec3::new(dice(), dice(), dice()) * 0.3);
            });
            columns
        };
        let (position, start) = (columns(), columns());
        let mass = |slot: usize| if slot.is_multiple_of(7) { 0.0 } else { 1.0 + (slot % 4) as f32 };
        let masses: Vec<[f32; LANES]> =
            (0..cells).map(|cell| core::array::from_fn(|lane| mass(cell * LANES + lane))).collect();
        let bounds = [StickBound::Exact, StickBound::AtLeast, StickBound::AtMost].into_iter().cycle();
        let pass = |(batch, bound)| BatchPass { batch, part: 0.4, bound, length_ratio: 1.1 };
        let order: Vec<BatchPass> = batches.iter().zip(bounds).map(pass).collect();
        let mut expected = start.clone();
        let mut damped_of = [0; 3];
        for &BatchPass { batch, part, bound, length_ratio } in &order {
            for i in places_of(batch) {
                let ends = sticks.slots(i).map(|slot| (slot as usize / LANES, slot as usize % LANES));
                let stick = DampedStick { rest_length: sticks.rest_length(i) * length_ratio, bound, part };
                let before = ends.map(|(cell, lane)| expected[cell].get(lane));
                let after = damped(
                    ends.map(|(cell, lane)| position[cell].get(lane)),
                    before,
                    ends.map(|(cell, lane)| masses[cell][lane]),
                    stick,
                );
                damped_of[bound as usize] += u32::from(after != before);
                for ((cell, lane), place) in ends.into_iter().zip(after) {
                    expected[cell].set(lane, place);
                }
            }
        }
        let [exact, at_least, at_most] = damped_of;
        assert!(exact > at_least && at_least > 100 && at_most > 100, "{damped_of:?} are damped");
        let window = 1 + batches.iter().map(ListedBatch::reach).sum::<usize>();
        for (isa, window) in Isa::available().into_iter().flat_map(|isa| [(isa, window), (isa, 100)]) {
            let (mut displacement, mut rows) = (start.clone(), <[Rows; 2]>::default());
            rows.iter_mut().for_each(|rows| rows.reset(window, cells));
            let damping = Damping {
                rows: &mut rows,
                position: &position,
                displacement: &mut displacement,
                inverse_mass: &masses,
                sticks: &sticks,
            };
            isa.run(Damp(damping, &order));
            assert!(displacement == expected, "{}", isa.name());
        }
    }
}
