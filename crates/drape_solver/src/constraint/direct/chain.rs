//! Chains of sticks, solved directly: all sticks of a chain at once, sixteen chains side by side in the lanes.
//!
//! ```text
//!   x0 o---C0---o x1 ---C1---o x2 --- ...      C_i = |x_{i+1} - x_i| - r,   n_i = (x_{i+1} - x_i) / |x_{i+1} - x_i|
//! ```
//!
//! Moving the particles by `w_i (lambda_i n_i - lambda_{i-1} n_{i-1})` brings every `C_i` to zero, to first order, if, with `c = 0`,
//!
//! ```text
//!   - w_i n_{i-1}.n_i lambda_{i-1}  +  (w_i + w_{i+1} + c) lambda_i  -  w_{i+1} n_i.n_{i+1} lambda_{i+1}  =  C_i
//! ```
//!
//! Sticks with a compliance keep `C_i = c lambda_i`, with `c` over the square of the substep: one implicit step of springs.
//!
//! This is a tridiagonal system: one elimination down the chain and one substitution back up (Thomas). Sweeps carry a
//! pull by a few sticks; this carries it through the whole chain. It is the projection onto the manifold of the
//! constraints of Goldenthal et al. 2007, "Efficient Simulation of Inextensible Cloth", equation 9, with one Newton
//! step, for a matrix that needs no sparse solver.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::constants::{CHAIN_STEP, GREATEST_INVERSE_MASS, LEAST_WEIGHT, TAUT};
use crate::constraint::direct::resistance::{compliances, eased_parts, regulariser};
use crate::constraint::direct::taut_chain::ChainTurn;
use crate::constraint::projection::Projection;
use crate::simd::cell_columns::CellColumn;
use crate::simd::columns::LANES;
use crate::simd::lanes::{Lanes3, load};
use crate::state::membrane::ElasticStick;

/// Sixteen chains: particle `i` of the chain in lane `l` is in lane `l` of cell `i`.
///
/// A lane whose inverse masses are all zero stays as it is.
pub(crate) struct Chains<'a> {
    pub position: CellColumn<'a>,
    /// Of all cells that those of `position` are a part of.
    pub inverse_mass: &'a [[f32; LANES]],
    /// The number of particles in a chain.
    pub count: usize,
    /// For each particle the lanes without a stick to the next one, lane 0 in the lowest bit. None if all have theirs.
    pub gaps: Option<&'a [u16]>,
    /// For each particle the compliance of its stick to the next one, in parts of that inside the cloth. None if they are alike.
    pub softness: Option<&'a [[f32; LANES]]>,
}

/// Scratch of the stick below each particle.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct ChainSticks {
    /// One over its length: the factor from separation to direction.
    pub scale: [f32; LANES],
    /// Factor of the next multiplier in the eliminated system.
    upper: [f32; LANES],
    /// The right-hand side on the way down; the multiplier times the scale on the way up.
    pub right: [f32; LANES],
}

/// Scratch of a solve. Only its memory outlives the solve.
#[derive(Clone, Debug, Default)]
pub(crate) struct ChainScratch {
    pub(super) sticks: Vec<ChainSticks>,
    pub(super) turns: Vec<ChainTurn>,
}

impl ChainScratch {
    /// Makes room for chains of `count` particles.
    pub fn reserve(&mut self, count: usize) {
        if self.sticks.len() < count {
            self.sticks.resize(count, ChainSticks::default());
            self.turns.resize(count, ChainTurn::default());
        }
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.sticks) + size_of_val(&*self.turns)
    }
}

impl Chains<'_> {
    /// One Newton step on all sticks of these chains. `edges` has the lanes of chains at an edge of the cloth.
    ///
    /// If the step is too long for the sticks to count as straight, a chain takes only a part of it, and its sticks are
    /// relaxed one by one from there. So it does if it is overstretched.
    pub fn solve<S: Simd>(
        &mut self,
        simd: S,
        scratch: &mut ChainScratch,
        stick: ElasticStick,
        edges: u16,
        projection: impl Projection,
    ) {
        if self.count >= 2 {
            simd.vectorize(
                #[inline(always)]
                || self.solve_lanes(simd, scratch, stick, edges, projection),
            );
        }
    }

    #[inline(always)]
    fn solve_lanes<S: Simd>(
        &mut self,
        simd: S,
        scratch: &mut ChainScratch,
        stick: ElasticStick,
        edges: u16,
        projection: impl Projection,
    ) {
        let rest = stick.rest;
        let compliance = compliances(simd, stick.compliance, edges);
        let stretch = self.eliminate(simd, scratch, rest, regulariser(stick), compliance);
        let [mut turn, tautness] = self.substitute(simd, scratch);
        let is_taut = tautness.simd_gt(f32x16::splat(simd, TAUT));
        if is_taut.any_true() {
            turn = is_taut.select(self.turn_implicitly(simd, scratch), turn);
        }
        let limit = CHAIN_STEP * rest;
        let is_too_long = turn.simd_gt(f32x16::splat(simd, limit * limit));
        let one = f32x16::splat(simd, 1.0);
        let part = is_too_long.select(limit / turn.max(f32x16::splat(simd, f32::MIN_POSITIVE)).sqrt(), one);
        let eased = eased_parts(simd, stick, stretch);
        let part = part * eased;
        if is_taut.any_true() {
            self.apply::<S, true>(simd, scratch, part, is_taut);
            self.apply_turns(simd, scratch, part, is_taut);
        } else {
            self.apply::<S, false>(simd, scratch, part, is_taut);
        }
        let is_eased = eased.simd_lt(one);
        if (is_too_long | is_eased).any_true() {
            self.sweep(simd, is_too_long.select(one, one - eased), rest, compliance, projection);
        }
        if is_eased.any_true() {
            self.sweep(simd, one - eased, rest, compliance, projection);
        }
    }

    /// Elimination down the chain: leaves `lambda_i = right_i + upper_i lambda_{i+1}`, and the direction of each stick. Returns
    /// by how many metres a stick that can give way is too long on average; one that is too short counts as 0.
    #[inline(always)]
    fn eliminate<S: Simd>(
        &self,
        simd: S,
        scratch: &mut ChainScratch,
        rest: f32,
        regulariser: f32,
        compliance: f32x16<S>,
    ) -> f32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let one = f32x16::splat(simd, 1.0);
        let least = f32x16::splat(simd, LEAST_WEIGHT);
        let sticks = &mut scratch.sticks[..self.count];
        let mut a = self.position(simd, 0);
        let mut wa = self.inverse_mass(simd, 0);
        let mut above = Lanes3 { x: zero, y: zero, z: zero };
        let (mut inverse_above, mut right_above) = (zero, zero);
        let (mut excess, mut number) = (zero, zero);
        for i in 0..self.count - 1 {
            let b = self.position(simd, i + 1);
            let wb = self.inverse_mass(simd, i + 1);
            let delta = b.minus(a);
            let length = delta.dot(delta).sqrt();
            let weight = wa + wb;
            // A stick without length has no direction, and one pinned at both ends does not move.
            let has_length: mask32x16<S> = self.with_stick(simd, i, length.simd_gt(zero));
            let is_free: mask32x16<S> = weight.simd_gt(least);
            let scale = has_length.select(one / length, zero);
            let direction = delta.times(scale);
            let can_give_way = has_length & is_free;
            let error = can_give_way.select(length - rest, zero);
            let lower = wa * above.dot(direction);
            let upper_above = lower * inverse_above;
            excess += error.max(zero);
            number += can_give_way.select(one, zero);
            let compliance = self.of_stick(simd, i, compliance);
            let own = (weight * (1.0 + regulariser)).max(weight + compliance).max(least);
            let pivot = own - lower * upper_above;
            let inverse = one / pivot;
            let right = (error + lower * right_above) * inverse;
            if i > 0 {
                sticks[i - 1].upper = upper_above.to_array();
            }
            sticks[i].scale = scale.to_array();
            sticks[i].right = right.to_array();
            (a, wa, above, inverse_above, right_above) = (b, wb, direction, inverse, right);
        }
        sticks[self.count - 2].upper = [0.0; LANES];
        excess / number.max(one)
    }

    /// Substitution up the chain: leaves each multiplier times the scale of its stick. Returns the square of the
    /// greatest move of a stick's two ends against each other, and the greatest pull over length and mass.
    #[inline(always)]
    fn substitute<S: Simd>(&self, simd: S, scratch: &mut ChainScratch) -> [f32x16<S>; 2] {
        let zero = f32x16::splat(simd, 0.0);
        let none = Lanes3 { x: zero, y: zero, z: zero };
        let sticks = &mut scratch.sticks[..self.count];
        let (mut multiplier, mut pull, mut step_below) = (zero, none, none);
        let (mut b, mut wb) = (self.position(simd, self.count - 1), self.inverse_mass(simd, self.count - 1));
        let (mut greatest, mut tautness) = (zero, zero);
        for i in (0..self.count - 1).rev() {
            let (a, wa) = (self.position(simd, i), self.inverse_mass(simd, i));
            multiplier = load(simd, &sticks[i].right) + load(simd, &sticks[i].upper) * multiplier;
            let scaled = multiplier * load(simd, &sticks[i].scale);
            sticks[i].right = scaled.to_array();
            // The stick of the previous round pulls the particle below down, and this one pulls it up.
            let pull_up = b.minus(a).times(scaled);
            tautness = tautness.max(scaled * wb.max(wa));
            let step = pull.minus(pull_up).times(wb);
            if i + 2 < self.count {
                let turn = step_below.minus(step);
                greatest = greatest.max(turn.dot(turn));
            }
            (b, wb, pull, step_below) = (a, wa, pull_up, step);
        }
        let turn = step_below.minus(pull.times(wb));
        [greatest.max(turn.dot(turn)), tautness]
    }

    /// Moves each particle by `part` of its step, but for the lanes in `is_taut`, if it `HAS_TAUT` ones.
    #[inline(always)]
    fn apply<S: Simd, const HAS_TAUT: bool>(
        &mut self,
        simd: S,
        scratch: &ChainScratch,
        part: f32x16<S>,
        is_taut: mask32x16<S>,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        let sticks = &scratch.sticks[..self.count];
        let mut a = self.position(simd, 0);
        let mut pull_up = Lanes3 { x: zero, y: zero, z: zero };
        for (i, stick) in sticks.iter().enumerate() {
            let (mut b, mut pull) = (a, Lanes3 { x: zero, y: zero, z: zero });
            if i + 1 < self.count {
                b = self.position(simd, i + 1);
                pull = b.minus(a).times(load(simd, &stick.right));
            }
            let step = pull.minus(pull_up).times(self.inverse_mass(simd, i) * part);
            let moved = a.plus(step);
            // Adding nothing would change the sign of a zero.
            let moved = if HAS_TAUT { a.or(is_taut, moved) } else { moved };
            self.set_position(i, moved);
            (a, pull_up) = (b, pull);
        }
    }

    /// Relaxes every second stick by these parts of its error, then the others.
    #[inline(always)]
    fn sweep<S: Simd>(
        &mut self,
        simd: S,
        part: f32x16<S>,
        rest: f32,
        compliance: f32x16<S>,
        projection: impl Projection,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        let least = f32x16::splat(simd, LEAST_WEIGHT);
        for i in (0..self.count - 1).step_by(2).chain((1..self.count - 1).step_by(2)) {
            let (wa, wb) = (self.inverse_mass(simd, i), self.inverse_mass(simd, i + 1));
            let (a, b) = (self.position(simd, i), self.position(simd, i + 1));
            let delta = b.minus(a);
            let error = projection.errors(simd, delta.dot(delta), f32x16::splat(simd, rest));
            let error = self.with_stick(simd, i, part.simd_gt(zero)).select(error * part, zero);
            let scale = error / ((wa + wb).max(least) + self.of_stick(simd, i, compliance));
            self.set_position(i, a.plus(delta.times(scale * wa)));
            self.set_position(i + 1, b.minus(delta.times(scale * wb)));
        }
    }

    /// Those of these `lanes` that have a stick from particle `i` to the next one.
    #[inline(always)]
    fn with_stick<S: Simd>(&self, simd: S, i: usize, lanes: mask32x16<S>) -> mask32x16<S> {
        match self.gaps {
            Some(gaps) => lanes & mask32x16::from_bitmask(simd, u64::from(!gaps[i])),
            None => lanes,
        }
    }

    /// The compliance of the stick below particle `i`.
    #[inline(always)]
    fn of_stick<S: Simd>(&self, simd: S, i: usize, compliance: f32x16<S>) -> f32x16<S> {
        match self.softness {
            Some(softness) => compliance * load(simd, &softness[i]),
            None => compliance,
        }
    }

    #[inline(always)]
    pub(super) fn position<S: Simd>(&self, simd: S, i: usize) -> Lanes3<S> {
        Lanes3::load(simd, self.position.get(i))
    }

    #[inline(always)]
    pub(super) fn set_position<S: Simd>(&mut self, i: usize, position: Lanes3<S>) {
        position.store(self.position.get_mut(i));
    }

    #[inline(always)]
    pub(super) fn inverse_mass<S: Simd>(&self, simd: S, i: usize) -> f32x16<S> {
        let greatest = f32x16::splat(simd, GREATEST_INVERSE_MASS);
        load(simd, &self.inverse_mass[self.position.place(i)]).min(greatest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    use crate::constants::{CHAIN_REGULARISER, ELASTIC_REGULARISER};
    use crate::constraint::direct::testing::{
        REST, RIGID, SOFT, Solve, chains, lane_of, softness, width_share,
    };
    use crate::constraint::testing;
    use crate::simd::columns::Cell;
    use crate::simd::isa::Isa;
    use crate::simd::miri::unless_miri;

    /// Gaps of chains in the lanes: each in other lanes, some side by side.
    fn gaps(count: usize) -> Vec<u16> {
        (0..count).map(|i| 0x2481_u16.rotate_left(i as u32) & if i % 3 == 0 { 0 } else { u16::MAX }).collect()
    }

    /// One chain, in double precision and stick by stick. `is_gap` tells after which particles the stick is missing.
    fn solved(
        position: &[Vec3],
        inverse_mass: &[f32],
        is_gap: impl Fn(usize) -> bool,
        compliance: impl Fn(usize) -> f64,
    ) -> Vec<DVec3> {
        let mut position: Vec<DVec3> = position.iter().map(|p| p.as_dvec3()).collect();
        let w: Vec<f64> = inverse_mass.iter().copied().map(f64::from).collect();
        let sticks = position.len() - 1;
        let delta = |i: usize| position[i + 1] - position[i];
        let direction = |i: usize| if is_gap(i) { DVec3::ZERO } else { delta(i).normalize_or_zero() };
        let n: Vec<DVec3> = (0..sticks).map(direction).collect();
        let (mut rows, mut right) = (vec![vec![0.0; sticks]; sticks], vec![0.0; sticks]);
        for i in 0..sticks {
            let weight = w[i] + w[i + 1];
            let is_alive = weight > 0.0 && n[i] != DVec3::ZERO;
            let compliance = compliance(i);
            let least = if compliance > 0.0 { ELASTIC_REGULARISER } else { CHAIN_REGULARISER };
            let regular = (weight * f64::from(least)).max(compliance);
            rows[i][i] = if weight > 0.0 { weight + regular } else { 1.0 };
            right[i] = if is_alive { delta(i).length() - f64::from(REST) } else { 0.0 };
            if i > 0 {
                rows[i][i - 1] = -w[i] * n[i - 1].dot(n[i]);
                rows[i - 1][i] = rows[i][i - 1];
            }
        }
        let lambda = testing::solved(rows, right);
        for i in 0..sticks {
            position[i] += n[i] * (w[i] * lambda[i]);
            position[i + 1] -= n[i] * (w[i + 1] * lambda[i]);
        }
        position
    }

    #[test]
    fn chains_go_where_the_whole_matrix_says() {
        let cases = [(RIGID, false), (SOFT, false), (RIGID, true), (SOFT, true)];
        for (isa, (stick, has_gaps)) in
            Isa::available().into_iter().flat_map(|isa| cases.map(|case| (isa, case)))
        {
            for count in [2, 3, unless_miri(8, 4), unless_miri(61, 5)] {
                let own = has_gaps.then(|| gaps(count));
                let (mut position, inverse_mass) = chains(count, 0.02);
                let before = position.clone();
                let inverse_mass = &inverse_mass[..];
                let gaps = own.as_deref();
                let softer = softness(count);
                let softness = has_gaps.then_some(&*softer);
                isa.run(Solve { position: &mut position, inverse_mass, count, gaps, softness, stick });
                (0..LANES).for_each(|lane| {
                    let start = lane_of(count, |cell| before[cell].get(lane));
                    let weights = lane_of(count, |cell| inverse_mass[cell][lane]);
                    let inside = f64::from(stick.compliance) * width_share(lane).recip();
                    let compliance =
                        |i: usize| inside * softness.map_or(1.0, |softness| f64::from(softness[i][lane]));
                    let is_gap = |i: usize| own.as_ref().is_some_and(|gaps| gaps[i] & (1 << lane) != 0);
                    for (i, expected) in solved(&start, &weights, is_gap, compliance).into_iter().enumerate()
                    {
                        let found = position[1 + 2 * i].get(lane).as_dvec3();
                        assert!(found.distance(expected) < 1e-5, "{} {count} {lane} {i}", isa.name());
                    }
                });
                let untouched = (0..count).all(|i| position[2 * i] == before[2 * i]);
                assert!(untouched, "cells of others stay as they are");
            }
        }
    }

    /// Chains bent to and fro and stretched to half as much again turn too far for one straight step.
    #[test]
    fn no_stick_turns_by_more_than_its_share() {
        let count = unless_miri(40, 6);
        let (mut position, inverse_mass) = chains(count, 1.0);
        let before = position.clone();
        Isa::detected().run(Solve {
            position: &mut position,
            inverse_mass: &inverse_mass,
            count,
            gaps: None,
            softness: None,
            stick: RIGID,
        });
        for lane in 0..LANES {
            for i in 0..count - 1 {
                let stick = |cells: &[Cell]| cells[3 + 2 * i].get(lane) - cells[1 + 2 * i].get(lane);
                // The step itself turns it by half a rest length, and then its error is taken by the sweep.
                let (turned, length) =
                    ((stick(&position) - stick(&before)).length(), stick(&before).length());
                assert!(turned < 2.0 * REST + length, "{lane} {i}: {turned}");
            }
        }
        assert!(
            position.iter().all(|cell| cell.axes().iter().all(|axis| axis.iter().all(|x| x.is_finite())))
        );
    }
}
