//! Listed bends in lanes, sixteen at a time: their weighted sums and the normals of the surface there.
//!
//! Design: `docs/design/bending.md`.

use core::iter::once;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::simd::columns::LANES;
use crate::simd::lanes::{Lanes3, load};
use crate::simd::rows::{Window, columns_of_rows, lanes_of_rows};
use crate::state::bends::ListedBend;

/// Sixteen bends.
pub(crate) type BendGroup = [ListedBend; LANES];

/// Calls `work` with all bends, sixteen by sixteen. The last ones are filled up with bends of no weight.
#[inline(always)]
pub(crate) fn for_each_group(bends: &[ListedBend], mut work: impl FnMut(usize, &BendGroup)) {
    let (groups, last) = bends.as_chunks();
    let mut filled = [ListedBend::default(); LANES];
    filled[..last.len()].copy_from_slice(last);
    let all = groups.iter().chain(once(&filled).filter(|_| !last.is_empty()));
    for (index, group) in all.enumerate() {
        work(index, group);
    }
}

/// Where sixteen bends are.
pub(crate) struct PlacedBends<S: Simd> {
    /// The ways from the first particle to the three others.
    to: [Lanes3<S>; 3],
    /// The weights of the three others.
    weights: [f32x16<S>; 3],
}

impl<S: Simd> PlacedBends<S> {
    /// Takes the positions from rows of the whole body.
    #[inline(always)]
    pub fn load(simd: S, places: &Window, group: &BendGroup) -> Self {
        let [a, b, c, d] = [
            corner(simd, places, group, 0),
            corner(simd, places, group, 1),
            corner(simd, places, group, 2),
            corner(simd, places, group, 3),
        ];
        let [_, wb, wc, wd] = columns_of_rows([
            four_weights(simd, group, 0),
            four_weights(simd, group, 4),
            four_weights(simd, group, 8),
            four_weights(simd, group, 12),
        ]);
        Self { to: [b.minus(a), c.minus(a), d.minus(a)], weights: [wb, wc, wd] }
    }

    /// The weighted sums of the positions.
    #[inline(always)]
    pub fn sum(&self) -> Lanes3<S> {
        let Self { to: [b, c, d], weights: [wb, wc, wd] } = *self;
        b.times(wb).plus(c.times(wc)).plus(d.times(wd))
    }

    /// Unit normals of the surface, zero where it has none, and where it has one: those of the threads of a torn grid, or at the edges
    /// of a mesh.
    #[inline(always)]
    pub fn normal(&self, simd: S, are_threads: bool) -> (Lanes3<S>, mask32x16<S>) {
        let [b, c, d] = self.to;
        let normal = if are_threads { c.cross(d.minus(b)) } else { b.cross(c.minus(d)) };
        normal.unit(simd)
    }
}

/// The positions of sixteen bends' particles in one corner.
#[inline(always)]
fn corner<S: Simd>(simd: S, places: &Window, group: &BendGroup, corner: usize) -> Lanes3<S> {
    let mut rows = [[0.0; 4]; LANES];
    for (row, bend) in rows.iter_mut().zip(group) {
        *row = places.get(simd, places.place(4 * bend.slots[corner])).to_array();
    }
    lanes_of_rows(simd, &rows)
}

/// The weights of four bends.
#[inline(always)]
fn four_weights<S: Simd>(simd: S, group: &BendGroup, first: usize) -> f32x16<S> {
    let mut rows = [[0.0; 4]; 4];
    for (row, bend) in rows.iter_mut().zip(&group[first..first + 4]) {
        *row = bend.weights;
    }
    load(simd, &rows.as_flattened().as_chunks().0[0])
}

/// One number of each of sixteen bends.
#[inline(always)]
pub(crate) fn number_of<S: Simd>(
    simd: S,
    group: &BendGroup,
    number: impl Fn(&ListedBend) -> f32,
) -> f32x16<S> {
    let mut numbers = [0.0; LANES];
    for (value, bend) in numbers.iter_mut().zip(group) {
        *value = number(bend);
    }
    load(simd, &numbers)
}
