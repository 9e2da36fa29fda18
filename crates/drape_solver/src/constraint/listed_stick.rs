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
use crate::simd::rows::{Rows, Window, block_count, columns_of_rows, rows_of_columns};
use crate::state::stick_list::{GROUP, ListedBatch, ListedSticks, StickGroup};
use crate::state::topology::StickBound;

/// A batch and what is done to its sticks.
#[derive(Clone, Copy)]
pub(crate) struct BatchPass<'a> {
    pub batch: &'a ListedBatch,
    /// The part of the errors, or of the speeds along the sticks, that is removed.
    pub part: f32,
    pub bound: StickBound,
    /// Factor on the rest lengths.
    pub length_ratio: f32,
}

/// Work on the listed sticks of a body in one sweep down its blocks.
pub(crate) trait BlockWork {
    /// Takes the particles of a block out of their cells.
    fn take<S: Simd>(&mut self, simd: S, block: usize);

    /// Works on the sticks of a batch that begin in a block.
    fn pass<S: Simd>(&mut self, simd: S, pass: BatchPass, block: usize);

    /// Puts the particles of a block back.
    fn put_back<S: Simd>(&mut self, simd: S, block: usize);

    /// Makes these passes in their order through a body of so many `cells`.
    #[inline(always)]
    fn descend<'b, S: Simd>(
        &mut self,
        simd: S,
        cells: usize,
        passes: impl Iterator<Item = BatchPass<'b>> + Clone,
    ) {
        let blocks = block_count(cells);
        let last_lag: usize = passes.clone().map(|pass| pass.batch.reach).sum();
        for time in 0..blocks + last_lag {
            if time < blocks {
                self.take(simd, time);
            }
            let mut lag = 0;
            for pass in passes.clone() {
                lag += pass.batch.reach;
                if let Some(block) = time.checked_sub(lag).filter(|&block| block < blocks) {
                    self.pass(simd, pass, block);
                }
            }
            if let Some(block) = time.checked_sub(last_lag) {
                self.put_back(simd, block);
            }
        }
    }
}

/// The relaxation of listed sticks: the columns and lists that it reads and writes.
pub(crate) struct Relaxation<'a, P> {
    pub rows: &'a mut Rows,
    pub position: &'a mut [Cell],
    pub inverse_mass: &'a [[f32; LANES]],
    pub sticks: &'a ListedSticks,
    pub projection: P,
}

/// Each part is a function of its own, because the compiler would take minutes for one function of all kernels.
impl<P: Projection> BlockWork for Relaxation<'_, P> {
    fn take<S: Simd>(&mut self, simd: S, block: usize) {
        simd.vectorize(
            #[inline(always)]
            || self.rows.take(simd, block, self.position, self.inverse_mass),
        );
    }

    #[inline(always)]
    fn pass<S: Simd>(&mut self, simd: S, pass: BatchPass, block: usize) {
        let Self { rows, sticks, projection, .. } = self;
        match OneSided::of(pass.bound, *projection) {
            None => relax_block(simd, rows, sticks, pass, block, *projection),
            Some(one) => relax_block(simd, rows, sticks, pass, block, one),
        }
    }

    fn put_back<S: Simd>(&mut self, simd: S, block: usize) {
        simd.vectorize(
            #[inline(always)]
            || self.rows.put_back(simd, block, self.position),
        );
    }
}

/// The sticks of a batch that begin in one block: those that go eight at a time, and those that go one by one.
pub(crate) fn sticks_of_block<'a>(
    sticks: &'a ListedSticks,
    batch: &ListedBatch,
    block: usize,
) -> (&'a [StickGroup], impl Iterator<Item = usize> + use<>) {
    let [first, end] = [block, block + 1].map(|block| batch.first_of_block[block] as usize);
    let groups = first.div_ceil(GROUP)..end / GROUP;
    if batch.is_independent && !groups.is_empty() {
        let alone = (first..groups.start * GROUP).chain(groups.end * GROUP..end);
        (&sticks.groups[groups], alone)
    } else {
        (&[], (first..end).chain(end..end))
    }
}

/// The sticks of a batch that begin in one block.
fn relax_block<S: Simd>(
    simd: S,
    rows: &mut Rows,
    sticks: &ListedSticks,
    BatchPass { batch, part, length_ratio, .. }: BatchPass,
    block: usize,
    projection: impl Projection,
) {
    let (groups, alone) = sticks_of_block(sticks, batch, block);
    simd.vectorize(
        #[inline(always)]
        || {
            let mut window = rows.window();
            for group in groups {
                project_group(simd, &mut window, group, [part, length_ratio], projection);
            }
            for place in alone {
                let (ends, rest_length) = (sticks.ends(place), sticks.rest_length(place) * length_ratio);
                project_row(simd, &mut window, ends, rest_length, part, projection);
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
    let (positions, [wp, wq]) = ends_of_rows(simd, window, [a, b]);
    let masses = [finite(wp), finite(wq)];
    let [p, q] = project(positions, masses, rest_length, stiffness, projection);
    window.set(a, f32x4::load_array(simd, [p.x, p.y, p.z, wp]));
    window.set(b, f32x4::load_array(simd, [q.x, q.y, q.z, wq]));
}

/// Two rows as vectors, and their fourth numbers.
#[inline(always)]
pub(crate) fn ends_of_rows<S: Simd>(simd: S, window: &Window, [a, b]: [usize; 2]) -> ([Vec3; 2], [f32; 2]) {
    let [px, py, pz, wp] = window.get(simd, a).to_array();
    let [qx, qy, qz, wq] = window.get(simd, b).to_array();
    ([Vec3::new(px, py, pz), Vec3::new(qx, qy, qz)], [wp, wq])
}

/// The inverse mass that is stored in a row: that of a pin is infinity there.
#[inline(always)]
pub(crate) fn finite(w: f32) -> f32 {
    if w < f32::INFINITY { w } else { 0.0 }
}

/// The inverse masses of eight rows.
#[inline(always)]
pub(crate) fn masses_of_eight<S: Simd>(simd: S, rows: [f32x8<S>; 4]) -> f32x8<S> {
    let [_, _, _, w] = columns_of_rows(rows);
    w.simd_lt(f32x8::splat(simd, f32::INFINITY)).select(w, f32x8::splat(simd, 0.0))
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
    let [x, y, z, w] = columns_of_rows(delta);
    let rest = f32x8::load_array_ref(simd, &group.rest_lengths) * length_ratio;
    let error = projection.errors_of_eight(simd, x * x + y * y + z * z, rest);
    let zero = f32x8::splat(simd, 0.0);
    if w.simd_eq(zero).all_true() {
        let error = error * (stiffness * 0.5);
        let errors = rows_of_columns([error; 4]);
        for i in 0..4 {
            // The fourth number, the inverse mass, stays.
            let both = delta[i] * errors[i];
            set_pair(window, a, i, p[i] + both);
            set_pair(window, b, i, q[i] - both);
        }
        return;
    }
    let (wp, wq) = (masses_of_eight(simd, p), masses_of_eight(simd, q));
    // Avoids a division by zero if both ends are pinned.
    let weight = (wp + wq).max(f32x8::splat(simd, f32::MIN_POSITIVE));
    let errors_p = rows_of_columns([error * (wp / weight * stiffness); 4]);
    let errors_q = rows_of_columns([error * (wq / weight * stiffness); 4]);
    let delta = rows_of_columns([x, y, z, zero]);
    for i in 0..4 {
        set_pair(window, a, i, p[i] + delta[i] * errors_p[i]);
        set_pair(window, b, i, q[i] - delta[i] * errors_q[i]);
    }
}

/// Eight rows, two in each vector.
#[inline(always)]
pub(crate) fn pairs<S: Simd>(simd: S, window: &Window, places: [usize; GROUP]) -> [f32x8<S>; 4] {
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
pub(crate) fn set_pair<S: Simd>(window: &mut Window, places: [usize; GROUP], i: usize, rows: f32x8<S>) {
    let (first, second) = rows.split();
    window.set(places[2 * i], first);
    window.set(places[2 * i + 1], second);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::projection::{Exact, SquareRootFree};
    use crate::constraint::testing::{listed_batches, places_of};
    use crate::simd::isa::{Isa, Kernel};
    use crate::simd::rows::BLOCK;

    const COUNT: u32 = 3 * BLOCK as u32 + 77;

    struct Relax<'a, 'b, P>(Relaxation<'a, P>, &'b [BatchPass<'b>]);

    impl<P: Projection> Kernel for Relax<'_, '_, P> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(mut self, simd: S) {
            let cells = self.0.position.len();
            self.0.descend(simd, cells, self.1.iter().copied());
        }
    }

    fn check(projection: impl Projection) {
        let mut sticks = ListedSticks::default();
        let batches = listed_batches(&mut sticks, COUNT, &[1, 3, 40, 600, 700, 2]);
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
                let pass = |(batch, (part, bound))| BatchPass { batch, part, bound, length_ratio: 1.0 };
                let bounds = [StickBound::Exact, StickBound::AtLeast, StickBound::AtMost].into_iter().cycle();
                let stiffness = [0.9, 0.5, 1.0, 0.3, 0.8, 1.0];
                let mut order: Vec<BatchPass> =
                    batches.iter().zip(stiffness.into_iter().zip(bounds)).map(pass).collect();
                if backwards {
                    order.reverse();
                }
                let mut expected = start.clone();
                for &BatchPass { batch, part, bound, .. } in &order {
                    for i in places_of(batch) {
                        let ends = sticks.slots(i).map(|slot| (slot as usize / LANES, slot as usize % LANES));
                        let places = ends.map(|(cell, lane)| expected[cell].get(lane));
                        let weights = ends.map(|(cell, lane)| masses[cell][lane]);
                        let strain = places[0].distance(places[1]) - sticks.rest_length(i);
                        if bound.violation(strain.into()) == 0.0 {
                            continue;
                        }
                        let moved = project(places, weights, sticks.rest_length(i), part, projection);
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
                    let relaxation = Relaxation {
                        rows: &mut rows,
                        position: &mut position,
                        inverse_mass: &masses,
                        sticks: &sticks,
                        projection,
                    };
                    isa.run(Relax(relaxation, &order));
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
        let relaxation = Relaxation {
            rows: &mut rows,
            position: &mut position,
            inverse_mass: &masses,
            sticks: &sticks,
            projection: Exact,
        };
        let pass = BatchPass { batch: &batch, part: 1.0, bound: StickBound::Exact, length_ratio: 1.0 };
        Isa::detected().run(Relax(relaxation, &[pass]));
        for slot in (0..40 * BLOCK).step_by(2) {
            let [a, b] = [slot, slot + 1].map(|slot| position[slot / LANES].get(slot % LANES));
            assert!((a.distance(b) - 1.0).abs() < 0.01);
        }
    }
}
