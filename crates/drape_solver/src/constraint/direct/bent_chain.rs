//! Chains that resist bending, solved directly: all bends of a chain at once, sixteen chains side by side in the lanes.
//!
//! ```text
//!   x0 o-----o-----o x2        K_i = x_i - 2 x_{i+1} + x_{i+2}
//!       \___ K_0 __/
//!             \___ K_1 __...
//! ```
//!
//! Moving the particles by `w_i (lambda_i - 2 lambda_{i-1} + lambda_{i-2})` is one implicit step of the energies
//! `K_i^2 / (2 compliance)` if (with `K_i` less its rest, where it has one)
//!
//! ```text
//!   c_{i-2} lambda_{i-2} + b_{i-1} lambda_{i-1} + (a_i + compliance / h^2) lambda_i + b_i lambda_{i+1} + c_i lambda_{i+2} = - K_i
//!   a_i = w_i + 4 w_{i+1} + w_{i+2}     b_i = - 2 w_{i+1} - 2 w_{i+2}     c_i = w_{i+2}
//! ```
//!
//! The matrix has five diagonals and serves the three coordinates: one elimination down the chain (L D L^T) and one substitution
//! back up. Relaxed one by one, bends of a fine or stiff cloth would pass on only a small part of the load in a substep, and the cloth would be as
//! limp as if it had a fraction of its rigidity.
//!
//! Design: `docs/design/bending.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::constants::{ALONG_ONE_LINE, LEAST_WEIGHT};
use crate::constraint::direct::chain::Chains;
use crate::constraint::direct::resistance::compliances;
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load};

/// Least compliance of a bend, in parts of the inverse masses that it moves: with less, rounding would break the elimination.
const LEAST_COMPLIANCE: f32 = 1e-5;

/// Scratch of the bend that begins at a particle.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct ChainBend {
    /// Entries of L to the two bends before.
    lower: [[f32; LANES]; 2],
    /// The right-hand side on the way down, over the pivot.
    right: Cell,
}

impl Chains<'_> {
    /// One implicit step of all bends of these chains. `bends` is scratch. `compliance` is that of a bend inside the cloth over
    /// the square of the substep, in 1/kg. `edges` has the lanes of chains at an edge of the cloth. `rest` has the weighted sums at
    /// rest, by the middle particle, of all cells that those of the chains are a part of; none where threads are straight at rest.
    pub fn bend<S: Simd>(
        &mut self,
        simd: S,
        bends: &mut [ChainBend],
        compliance: f32,
        edges: u16,
        rest: Option<&[Cell]>,
    ) {
        if let Some(count) = self.count.checked_sub(2).filter(|&count| count > 0) {
            let bends = &mut bends[..count];
            simd.vectorize(
                #[inline(always)]
                || {
                    self.eliminate_bends(simd, bends, compliance, edges, rest);
                    self.unbend(simd, bends);
                },
            );
        }
    }

    #[inline(always)]
    fn eliminate_bends<S: Simd>(
        &self,
        simd: S,
        bends: &mut [ChainBend],
        compliance: f32,
        edges: u16,
        at_rest: Option<&[Cell]>,
    ) {
        let splat = |value| f32x16::splat(simd, value);
        let (zero, one, two) = (splat(0.0), splat(1.0), splat(2.0));
        let own_compliance = compliances(simd, compliance, edges);
        let [mut wa, mut wb] = [self.inverse_mass(simd, 0), self.inverse_mass(simd, 1)];
        let mut b = self.position(simd, 1);
        let mut above = b.minus(self.position(simd, 0));
        // Of the two bends before: inverse pivots, couplings to this bend and the one before it, right-hand sides.
        let none = Lanes3 { x: zero, y: zero, z: zero };
        let (mut inverse, mut coupling, mut far) = ([zero; 2], zero, [zero; 2]);
        let mut lower_before = zero;
        let mut right = [none; 2];
        for (i, bend) in bends.iter_mut().enumerate() {
            let (c, wc) = (self.position(simd, i + 2), self.inverse_mass(simd, i + 2));
            let below = c.minus(b);
            let mut sum = below.minus(above);
            if let Some(at_rest) = at_rest {
                sum = sum.minus(turned(sum, Lanes3::load(simd, &at_rest[self.position.place(i + 1)])));
            }
            let moved = wa + wb * 4.0 + wc;
            let compliance = own_compliance.max(moved * LEAST_COMPLIANCE);
            let far_entry = far[1] * inverse[1];
            let near = coupling - far[1] * lower_before;
            let near_entry = near * inverse[0];
            let pivot = moved + compliance - far_entry * far[1] - near_entry * near;
            let inverse_pivot = one / pivot.max(splat(LEAST_WEIGHT));
            let rest = right[0].times(near_entry).plus(right[1].times(far_entry));
            let now = none.minus(sum).minus(rest);
            bend.lower = [near_entry.to_array(), far_entry.to_array()];
            now.times(inverse_pivot).store(&mut bend.right);
            inverse = [inverse_pivot, inverse[0]];
            right = [now, right[0]];
            lower_before = near_entry;
            far = [wc, far[0]];
            coupling = zero - two * (wb + wc);
            (wa, wb, b, above) = (wb, wc, c, below);
        }
    }

    /// Substitution up the chain; each particle moves as soon as the multipliers of its three bends are known.
    #[inline(always)]
    fn unbend<S: Simd>(&mut self, simd: S, bends: &[ChainBend]) {
        let zero = f32x16::splat(simd, 0.0);
        let none = Lanes3 { x: zero, y: zero, z: zero };
        // The multipliers of the two bends below, and their entries of L.
        let (mut below, mut near, mut far) = ([none; 2], zero, [zero; 2]);
        for (i, bend) in bends.iter().enumerate().rev() {
            let known = below[0].times(near).plus(below[1].times(far[1]));
            let multiplier = Lanes3::load(simd, &bend.right).minus(known);
            self.push(simd, i + 2, [multiplier, below[0], below[1]]);
            (near, far) = (load(simd, &bend.lower[0]), [load(simd, &bend.lower[1]), far[0]]);
            below = [multiplier, below[0]];
        }
        self.push(simd, 1, [none, below[0], below[1]]);
        self.push(simd, 0, [none, none, below[0]]);
    }

    /// Moves particle `i` by the multipliers of the bends of which it is the end, the middle and the start.
    #[inline(always)]
    fn push<S: Simd>(&mut self, simd: S, i: usize, [end, middle, start]: [Lanes3<S>; 3]) {
        let force = end.minus(middle.times(f32x16::splat(simd, 2.0))).plus(start);
        let step = force.times(self.inverse_mass(simd, i));
        self.set_position(i, self.position(simd, i).plus(step));
    }
}

/// The `rest` of a bend, turned to its weighted `sum`: a pull along this does not turn the body, which has turned since the rest was found.
/// As it is where the two are not nearly along one line: then the direction of the sum is noise, as in what was pressed flat.
#[inline(always)]
fn turned<S: Simd>(sum: Lanes3<S>, rest: Lanes3<S>) -> Lanes3<S> {
    let (squared, of_rest, product) = (sum.dot(sum), rest.dot(rest), rest.dot(sum));
    let size = (of_rest / squared).sqrt();
    let size = product.simd_ge(f32x16::splat(product.simd, 0.0)).select(size, -size);
    let is_along = (product * product).simd_gt(squared * of_rest * ALONG_ONE_LINE);
    sum.times(size).or(is_along, rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    use crate::constraint::testing::{self, dice};
    use crate::simd::cell_columns::CellColumns;
    use crate::simd::isa::{Isa, Kernel};
    use crate::simd::miri::unless_miri;

    const COMPLIANCE: f32 = 2.0;
    const EDGES: u16 = 0x8001;

    struct Bend<'a>(Chains<'a>, &'a [Cell]);

    impl Kernel for Bend<'_> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(mut self, simd: S) {
            let mut bends = vec![ChainBend::default(); self.0.count];
            self.0.bend(simd, &mut bends, COMPLIANCE, EDGES, Some(self.1));
        }
    }

    /// One chain, in double precision, by elimination of the whole matrix.
    fn solved(position: &[Vec3], inverse_mass: &[f32], rest: &[Vec3], compliance: f64) -> Vec<DVec3> {
        let [mut position, rest] =
            [position, rest].map(|all| -> Vec<DVec3> { all.iter().map(|p| p.as_dvec3()).collect() });
        let w: Vec<f64> = inverse_mass.iter().copied().map(f64::from).collect();
        let bends = position.len() - 2;
        let weights = |bend: usize, i: usize| match i.checked_sub(bend) {
            Some(0 | 2) => 1.0,
            Some(1) => -2.0,
            _ => 0.0,
        };
        let all = 0..position.len();
        let mut rows: Vec<Vec<f64>> = (0..bends)
            .map(|i| {
                (0..bends).map(|k| all.clone().map(|p| weights(i, p) * w[p] * weights(k, p)).sum()).collect()
            })
            .collect();
        let sum = |i: usize| {
            let (sum, rest) = (position[i] - position[i + 1] * 2.0 + position[i + 2], rest[i + 1]);
            let turned = sum.normalize_or_zero() * rest.length().copysign(rest.dot(sum));
            let cosine = sum.normalize_or_zero().dot(rest.normalize_or_zero());
            sum - if cosine * cosine > f64::from(ALONG_ONE_LINE) { turned } else { rest }
        };
        let right = (0..bends).map(|i| -sum(i)).collect();
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] += compliance;
        }
        for (bend, multiplier) in testing::solved(rows, right).into_iter().enumerate() {
            for i in bend..bend + 3 {
                position[i] += multiplier * (w[i] * weights(bend, i));
            }
        }
        position
    }

    /// Sixteen crooked chains side by side, some of their particles pinned, heavy or at an edge of the cloth.
    #[test]
    fn chains_go_where_the_whole_matrix_says() {
        for isa in Isa::available() {
            for count in [3, 4, unless_miri(61, 6)] {
                let mut dice = dice(3);
                let mut position = vec![Cell::default(); 2 * count];
                let mut inverse_mass = vec![[1.0; LANES]; 2 * count];
                let mut rest = vec![Cell::default(); 2 * count];
                for (cell, masses) in inverse_mass.iter_mut().enumerate() {
                    for (lane, mass) in masses.iter_mut().enumerate() {
                        let place = Vec3::new(cell as f32 * 0.05, dice() * 0.05, dice() * 0.05);
                        position[cell].set(lane, place);
                        rest[cell].set(lane, Vec3::new(dice(), dice(), dice()) * 0.02);
                        *mass = [0.0, 0.1, 2.0, 2.0, 2.0, 4.0][(dice().abs() * 5.99) as usize];
                    }
                }
                let before = position.clone();
                let mut columns = CellColumns::new(&mut position, 2);
                let chains = Chains {
                    position: columns.column(0),
                    inverse_mass: &inverse_mass,
                    count,
                    gaps: None,
                    softness: None,
                };
                isa.run(Bend(chains, &rest));
                (0..LANES).for_each(|lane| {
                    let start: Vec<Vec3> = (0..count).map(|i| before[2 * i].get(lane)).collect();
                    let weights: Vec<f32> = (0..count).map(|i| inverse_mass[2 * i][lane]).collect();
                    let width = if EDGES & (1 << lane) == 0 { 1.0 } else { 0.5 };
                    let rest: Vec<Vec3> = (0..count).map(|i| rest[2 * i].get(lane)).collect();
                    let expected = solved(&start, &weights, &rest, f64::from(COMPLIANCE) / width);
                    for (i, expected) in expected.into_iter().enumerate() {
                        let found = position[2 * i].get(lane).as_dvec3();
                        assert!(found.distance(expected) < 2e-6, "{} {count} {lane} {i}", isa.name());
                    }
                });
            }
        }
    }
}
