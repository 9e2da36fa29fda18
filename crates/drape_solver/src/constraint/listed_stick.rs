//! The relaxation of [listed sticks](crate::state::stick_list): those of irregular meshes and rigs.
//!
//! The batches of a body are relaxed in one sweep through its memory. A batch has its sticks in the order of slots, cut
//! into the blocks of particles where they begin. It works on a block as soon as the previous batch is done with all
//! blocks that its sticks reach. Each particle thus sees its sticks in the order of the batches, as if each batch went
//! through the whole body; but only a [window](crate::simd::rows) of the body is in use at a time.
//!
//! `project_group` corrects eight sticks, `project` one; the formula of the error is in `projection.rs`.
//!
//! Design: `docs/design/listed_sticks.md`.

use fearless_simd::{Simd, f32x4, f32x8, prelude::*};
use glam::Vec3;

use crate::constraint::projection::{OneSided, Projection};
use crate::simd::columns::{Cell, LANES};
use crate::simd::rows::{Rows, Window, block_count, columns_of_eight, rows_of_eight};
use crate::state::stick_list::{GROUP, ListedBatch, ListedSticks, StickGroup};
use crate::state::topology::StickBound;

/// A batch with its stiffness and bound in this iteration.
#[derive(Clone, Copy)]
pub(crate) struct RelaxedBatch<'a> {
    pub batch: &'a ListedBatch,
    /// The part of the error that one iteration removes.
    pub stiffness: f32,
    pub bound: StickBound,
    /// Factor on the rest lengths.
    pub length_ratio: f32,
}

/// One sweep of all batches through a body: the columns and lists that it reads and writes.
pub(crate) struct Descent<'a> {
    pub rows: &'a mut Rows,
    pub position: &'a mut [Cell],
    pub inverse_mass: &'a [[f32; LANES]],
    pub sticks: &'a ListedSticks,
}

impl Descent<'_> {
    /// Relaxes these batches in their order.
    #[inline(always)]
    pub fn relax<'b, S: Simd>(
        self,
        simd: S,
        batches: impl Iterator<Item = RelaxedBatch<'b>> + Clone,
        projection: impl Projection,
    ) {
        let Self { rows, position, inverse_mass, sticks } = self;
        let blocks = block_count(position.len());
        let last_lag: usize = batches.clone().map(|relaxed| relaxed.batch.reach).sum();
        for time in 0..blocks + last_lag {
            if time < blocks {
                take(simd, rows, time, position, inverse_mass);
            }
            let mut lag = 0;
            for relaxed in batches.clone() {
                lag += relaxed.batch.reach;
                if let Some(block) = time.checked_sub(lag).filter(|&block| block < blocks) {
                    match OneSided::of(relaxed.bound, projection) {
                        None => relax_block(simd, rows, sticks, relaxed, block, projection),
                        Some(one) => relax_block(simd, rows, sticks, relaxed, block, one),
                    }
                }
            }
            if let Some(block) = time.checked_sub(last_lag) {
                put_back(simd, rows, block, position);
            }
        }
    }
}

/// [`Rows::take`] as a function of its own, because the compiler would take minutes for one function of all kernels.
fn take<S: Simd>(simd: S, rows: &mut Rows, block: usize, position: &[Cell], inverse_mass: &[[f32; LANES]]) {
    simd.vectorize(
        #[inline(always)]
        || rows.take(simd, block, position, inverse_mass),
    );
}

/// [`Rows::put_back`] likewise.
fn put_back<S: Simd>(simd: S, rows: &Rows, block: usize, position: &mut [Cell]) {
    simd.vectorize(
        #[inline(always)]
        || rows.put_back(simd, block, position),
    );
}

/// The sticks of a batch that begin in one block.
fn relax_block<S: Simd>(
    simd: S,
    rows: &mut Rows,
    sticks: &ListedSticks,
    relaxed: RelaxedBatch,
    block: usize,
    projection: impl Projection,
) {
    let RelaxedBatch { batch, stiffness, length_ratio, .. } = relaxed;
    let [first, end] = [block, block + 1].map(|block| batch.first_of_block[block] as usize);
    let groups = first.div_ceil(GROUP)..end / GROUP;
    let (before, groups, after) = if batch.is_independent && !groups.is_empty() {
        (first..groups.start * GROUP, &sticks.groups[groups.clone()], groups.end * GROUP..end)
    } else {
        (first..end, &[][..], end..end)
    };
    simd.vectorize(
        #[inline(always)]
        || {
            let mut window = rows.window();
            for group in groups {
                project_group(simd, &mut window, group, [stiffness, length_ratio], projection);
            }
            for place in before.chain(after) {
                let (ends, rest_length) = (sticks.ends(place), sticks.rest_length(place) * length_ratio);
                project_row(simd, &mut window, ends, rest_length, stiffness, projection);
            }
        },
    );
}

/// One stick between `ends` with these inverse masses: the reference for all kernels. Returns the new places of its
/// ends.
#[inline(always)]
pub(crate) fn project(
    [p, q]: [Vec3; 2],
    [wp, wq]: [f32; 2],
    rest_length: f32,
    stiffness: f32,
    projection: impl Projection,
) -> [Vec3; 2] {
    let weight = wp + wq;
    if weight > 0.0 {
        let delta = q - p;
        let error = projection.error(delta.length_squared(), rest_length);
        // Equal masses are the rule, and halving is quicker than two divisions.
        let [share_p, share_q] = if wp == wq { [0.5; 2] } else { [wp / weight, wq / weight] };
        [p + delta * (error * (stiffness * share_p)), q - delta * (error * (stiffness * share_q))]
    } else {
        [p, q]
    }
}

/// One stick in rows.
#[inline(always)]
fn project_row<S: Simd>(
    simd: S,
    window: &mut Window,
    ends: [u32; 2],
    rest_length: f32,
    stiffness: f32,
    projection: impl Projection,
) {
    let [a, b] = ends.map(|first| window.place(first));
    let [[px, py, pz, wp], [qx, qy, qz, wq]] = [a, b].map(|place| window.get(simd, place).to_array());
    let positions = [Vec3::new(px, py, pz), Vec3::new(qx, qy, qz)];
    let masses = [wp, wq].map(|w| if w < f32::INFINITY { w } else { 0.0 });
    let [p, q] = project(positions, masses, rest_length, stiffness, projection);
    window.set(a, f32x4::load_array(simd, [p.x, p.y, p.z, wp]));
    window.set(b, f32x4::load_array(simd, [q.x, q.y, q.z, wq]));
}

/// The kernel: eight sticks that share no particle. Differences and moves are computed in rows, errors in lanes.
///
/// If the two masses of each stick are equal, each end moves by half the error. That is the result of the general
/// formula, to the last bit, without its divisions.
#[inline(always)]
fn project_group<S: Simd>(
    simd: S,
    window: &mut Window,
    group: &StickGroup,
    [stiffness, length_ratio]: [f32; 2],
    projection: impl Projection,
) {
    let [a, b] = group.ends.map(|ends| ends.map(|first| window.place(first)));
    let [p, q] = [pairs(simd, window, a), pairs(simd, window, b)];
    let delta = [q[0] - p[0], q[1] - p[1], q[2] - p[2], q[3] - p[3]];
    let [x, y, z, w] = columns_of_eight(delta);
    let rest = f32x8::load_array_ref(simd, &group.rest_lengths) * length_ratio;
    let error = projection.errors_of_eight(simd, x * x + y * y + z * z, rest);
    let zero = f32x8::splat(simd, 0.0);
    if w.simd_eq(zero).all_true() {
        let error = error * (stiffness * 0.5);
        let errors = rows_of_eight([error; 4]);
        for i in 0..4 {
            // The fourth number, the inverse mass, stays.
            let both = delta[i] * errors[i];
            set_pair(window, a, i, p[i] + both);
            set_pair(window, b, i, q[i] - both);
        }
        return;
    }
    let mass = |rows| {
        let [_, _, _, w] = columns_of_eight(rows);
        w.simd_lt(f32x8::splat(simd, f32::INFINITY)).select(w, zero)
    };
    let (wp, wq) = (mass(p), mass(q));
    // Avoids a division by zero if both ends are pinned.
    let weight = (wp + wq).max(f32x8::splat(simd, f32::MIN_POSITIVE));
    let errors_p = rows_of_eight([error * (wp / weight * stiffness); 4]);
    let errors_q = rows_of_eight([error * (wq / weight * stiffness); 4]);
    let delta = rows_of_eight([x, y, z, zero]);
    for i in 0..4 {
        set_pair(window, a, i, p[i] + delta[i] * errors_p[i]);
        set_pair(window, b, i, q[i] - delta[i] * errors_q[i]);
    }
}

/// Eight rows, two in each vector.
#[inline(always)]
fn pairs<S: Simd>(simd: S, window: &Window, places: [usize; GROUP]) -> [f32x8<S>; 4] {
    [
        pair(simd, window, [places[0], places[1]]),
        pair(simd, window, [places[2], places[3]]),
        pair(simd, window, [places[4], places[5]]),
        pair(simd, window, [places[6], places[7]]),
    ]
}

/// Two rows.
#[inline(always)]
fn pair<S: Simd>(simd: S, window: &Window, [a, b]: [usize; 2]) -> f32x8<S> {
    window.get(simd, a).combine(window.get(simd, b))
}

/// Stores rows 2 `i` and 2 `i` + 1 of eight.
#[inline(always)]
fn set_pair<S: Simd>(window: &mut Window, places: [usize; GROUP], i: usize, rows: f32x8<S>) {
    let (first, second) = rows.split();
    window.set(places[2 * i], first);
    window.set(places[2 * i + 1], second);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::projection::{Exact, SquareRootFree};
    use crate::simd::isa::{Isa, Kernel};
    use crate::simd::rows::BLOCK;

    const COUNT: u32 = 3 * BLOCK as u32 + 77;

    struct Relax<'a, 'b, P>(Descent<'a>, &'b [RelaxedBatch<'b>], P);

    impl<P: Projection> Kernel for Relax<'_, '_, P> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            self.0.relax(simd, self.1.iter().copied(), self.2);
        }
    }

    /// Batches of `step` as the distance between the ends of a stick, each of which keeps its particles to itself.
    fn batches(sticks: &mut ListedSticks, steps: &[u32]) -> Vec<ListedBatch> {
        let cells = (COUNT as usize).div_ceil(LANES);
        let batch = |&step: &u32| {
            let first = sticks.begin_batch();
            let starts = (0..COUNT - step).filter(|i| i / step % 2 == 0 && i % 9 != 4);
            for i in starts {
                sticks.push([i, i + step], 0.3 + (i % 5) as f32 * 0.1);
            }
            let mut batch = ListedBatch::new(first, true);
            batch.arrange(sticks, sticks.next - first, cells, |slot| slot);
            batch
        };
        steps.iter().map(batch).collect()
    }

    fn check(projection: impl Projection) {
        let mut sticks = ListedSticks::default();
        let batches = batches(&mut sticks, &[1, 3, 40, 600, 700, 2]);
        let cells = (COUNT as usize).div_ceil(LANES);
        let mut start = vec![Cell::default(); cells];
        for slot in 0..COUNT as usize {
            let spread = |k: f32| libm::sinf(slot as f32 * k) * 3.0;
            start[slot / LANES].set(slot % LANES, Vec3::new(spread(0.7), spread(1.3), spread(2.9)));
        }
        let uneven = |slot: usize| if slot.is_multiple_of(7) { 0.0 } else { 1.0 + (slot % 4) as f32 };
        for mass in [&|_| 2.5, &uneven, &|_| 0.0] as [&dyn Fn(usize) -> f32; 3] {
            let masses: Vec<[f32; LANES]> =
                (0..cells).map(|cell| core::array::from_fn(|lane| mass(cell * LANES + lane))).collect();
            for backwards in [false, true] {
                let relaxed =
                    |(batch, (stiffness, bound))| RelaxedBatch { batch, stiffness, bound, length_ratio: 1.0 };
                let bounds = [StickBound::Exact, StickBound::AtLeast, StickBound::AtMost].into_iter().cycle();
                let stiffness = [0.9, 0.5, 1.0, 0.3, 0.8, 1.0];
                let mut order: Vec<RelaxedBatch> =
                    batches.iter().zip(stiffness.into_iter().zip(bounds)).map(relaxed).collect();
                if backwards {
                    order.reverse();
                }
                let mut expected = start.clone();
                for &RelaxedBatch { batch, stiffness, bound, .. } in &order {
                    let last = batch.first_of_block.last().map_or(0, |&last| last as usize);
                    for i in batch.first..last {
                        let ends = sticks.slots(i).map(|slot| (slot as usize / LANES, slot as usize % LANES));
                        let places = ends.map(|(cell, lane)| expected[cell].get(lane));
                        let weights = ends.map(|(cell, lane)| masses[cell][lane]);
                        let strain = places[0].distance(places[1]) - sticks.rest_length(i);
                        if bound.violation(strain.into()) == 0.0 {
                            continue;
                        }
                        let moved = project(places, weights, sticks.rest_length(i), stiffness, projection);
                        for ((cell, lane), place) in ends.into_iter().zip(moved) {
                            expected[cell].set(lane, place);
                        }
                    }
                }
                let window = 1 + batches.iter().map(ListedBatch::reach).sum::<usize>();
                for (isa, window) in Isa::available().into_iter().flat_map(|isa| [(isa, window), (isa, 100)])
                {
                    let (mut position, mut rows) = (start.clone(), Rows::default());
                    rows.reset(window, cells);
                    let sweep = Descent {
                        rows: &mut rows,
                        position: &mut position,
                        inverse_mass: &masses,
                        sticks: &sticks,
                    };
                    isa.run(Relax(sweep, &order, projection));
                    assert!(position == expected, "{} backwards: {backwards}", isa.name());
                }
            }
        }
    }

    /// The sweep, eight sticks at a time and block after block, must move every particle as one stick after another does,
    /// batch after batch, to the last bit.
    #[test]
    #[cfg_attr(miri, ignore = "it takes more than three blocks of particles")]
    fn the_sweep_and_single_sticks_give_the_same_bits() {
        check(Exact);
        check(SquareRootFree);
    }

    /// A body longer than its window: blocks take turns in it.
    #[test]
    #[cfg_attr(miri, ignore = "it takes twenty blocks of particles")]
    fn a_window_smaller_than_the_body_is_enough() {
        let cells = 40 * BLOCK / LANES;
        let mut sticks = ListedSticks::default();
        let first = |i: u32| [2 * i, 2 * i + 1];
        (0..20 * BLOCK as u32).for_each(|i| sticks.push(first(i), 1.0));
        let mut batch = ListedBatch::new(0, true);
        batch.arrange(&mut sticks, 20 * BLOCK, cells, |slot| slot);
        let mut rows = Rows::default();
        rows.reset(1 + batch.reach(), cells);
        assert_eq!(rows.bytes(), BLOCK * size_of::<[f32; 4]>());
        let mut position = vec![Cell::default(); cells];
        for slot in 0..40 * BLOCK {
            position[slot / LANES].set(slot % LANES, Vec3::X * (slot * 3) as f32);
        }
        let masses = vec![[1.0; LANES]; cells];
        let sweep =
            Descent { rows: &mut rows, position: &mut position, inverse_mass: &masses, sticks: &sticks };
        let relaxed =
            RelaxedBatch { batch: &batch, stiffness: 1.0, bound: StickBound::Exact, length_ratio: 1.0 };
        Isa::detected().run(Relax(sweep, &[relaxed], Exact));
        for slot in (0..40 * BLOCK).step_by(2) {
            let [a, b] = [slot, slot + 1].map(|slot| position[slot / LANES].get(slot % LANES));
            assert!((a.distance(b) - 1.0).abs() < 0.01);
        }
    }
}
