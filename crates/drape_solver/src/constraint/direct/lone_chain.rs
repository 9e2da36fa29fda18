//! One chain in scalar code: the same as [`chain`](crate::constraint::direct::chain) in each of its lanes, to the bit.
//! Ropes use it, and loose lines of torn grids, as they have no other chains to fill the lanes.
//!
//! Design: `docs/design/line_solves.md`.

use glam::Vec3;

use crate::constants::{CHAIN_STEP, GREATEST_INVERSE_MASS, LEAST_WEIGHT, TAUT};
use crate::constraint::direct::resistance::{eased_part, regulariser};
use crate::constraint::projection::Projection;
use crate::simd::columns::{Cell, LANES};
use crate::state::membrane::ElasticStick;

/// Scratch of a particle and of the stick below it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LoneStick {
    /// One over its length.
    scale: f32,
    /// Factor of the next multiplier in the eliminated system.
    upper: f32,
    /// The right-hand side on the way down; the multiplier times the scale on the way up.
    right: f32,
    turn: LoneTurn,
}

/// Scratch of a particle in a taut chain, as [`taut_chain`](crate::constraint::direct::taut_chain) explains.
#[derive(Clone, Copy, Debug, Default)]
struct LoneTurn {
    step: Vec3,
    across: Vec3,
    upper: f32,
}

/// A chain of the particles in these slots.
pub(crate) struct LoneChain<'a> {
    pub position: &'a mut [Cell],
    pub inverse_mass: &'a [[f32; LANES]],
    pub slots: &'a [u32],
    /// For each particle the compliance of its stick to the next one, in parts of that inside the cloth. None if all are alike.
    pub softness: Option<&'a [f32]>,
}

impl LoneChain<'_> {
    /// One Newton step on all its sticks. `sticks` is scratch.
    #[inline(always)]
    pub fn solve(&mut self, sticks: &mut [LoneStick], stick: ElasticStick, projection: impl Projection) {
        let Some(count) = self.slots.len().checked_sub(1).filter(|&count| count > 0) else {
            return;
        };
        let sticks = &mut sticks[..=count];
        let error = self.eliminate(sticks, stick);
        let [mut turn, tautness] = self.substitute(sticks);
        let is_taut = tautness > TAUT;
        if is_taut {
            turn = self.turn_implicitly(sticks);
        }
        let limit = CHAIN_STEP * stick.rest;
        let is_too_long = turn > limit * limit;
        let part = if is_too_long { limit / turn.sqrt() } else { 1.0 };
        let eased = eased_part(stick, error);
        let part = part * eased;
        if is_taut {
            for (i, stick) in sticks.iter().enumerate() {
                self.set_position(i, self.position(i) + stick.turn.step * part);
            }
        } else {
            self.apply(sticks, part);
        }
        if is_too_long || eased < 1.0 {
            self.sweep(if is_too_long { 1.0 } else { 1.0 - eased }, stick, projection);
        }
        if eased < 1.0 {
            self.sweep(1.0 - eased, stick, projection);
        }
    }

    #[inline(always)]
    fn eliminate(&self, sticks: &mut [LoneStick], stick: ElasticStick) -> f32 {
        let (rest, regulariser) = (stick.rest, regulariser(stick));
        let mut greatest = 0.0_f32;
        let (mut a, mut wa) = (self.position(0), self.inverse_mass(0));
        let mut above = Vec3::ZERO;
        let (mut inverse_above, mut right_above) = (0.0, 0.0);
        for i in 0..sticks.len() - 1 {
            let (b, wb) = (self.position(i + 1), self.inverse_mass(i + 1));
            let delta = b - a;
            let length = delta.length_squared().sqrt();
            let weight = wa + wb;
            let has_length = length > 0.0;
            let scale = if has_length { 1.0 / length } else { 0.0 };
            let direction = delta * scale;
            let error = if has_length && weight > LEAST_WEIGHT { length - rest } else { 0.0 };
            let lower = wa * above.dot(direction);
            let upper_above = lower * inverse_above;
            greatest = greatest.max(error);
            let own =
                (weight * (1.0 + regulariser)).max(weight + self.compliance(i, stick)).max(LEAST_WEIGHT);
            let pivot = own - lower * upper_above;
            let inverse = 1.0 / pivot;
            let right = (error + lower * right_above) * inverse;
            if i > 0 {
                sticks[i - 1].upper = upper_above;
            }
            sticks[i] = LoneStick { scale, right, ..LoneStick::default() };
            (a, wa, above, inverse_above, right_above) = (b, wb, direction, inverse, right);
        }
        greatest
    }

    #[inline(always)]
    fn substitute(&self, sticks: &mut [LoneStick]) -> [f32; 2] {
        let (mut multiplier, mut greatest, mut tautness) = (0.0, 0.0_f32, 0.0_f32);
        let (mut pull, mut step_below) = (Vec3::ZERO, None);
        let last = sticks.len() - 1;
        let mut b = self.position(last);
        for (i, stick) in sticks[..last].iter_mut().enumerate().rev() {
            let a = self.position(i);
            multiplier = stick.right + stick.upper * multiplier;
            stick.right = multiplier * stick.scale;
            let pull_up = (b - a) * stick.right;
            let w = self.inverse_mass(i + 1);
            tautness = tautness.max(stick.right * w.max(self.inverse_mass(i)));
            let step = (pull - pull_up) * w;
            greatest =
                step_below.map_or(greatest, |below: Vec3| greatest.max((below - step).length_squared()));
            (b, pull, step_below) = (a, pull_up, Some(step));
        }
        let step = pull * self.inverse_mass(0);
        [step_below.map_or(greatest, |below| greatest.max((below - step).length_squared())), tautness]
    }

    #[inline(always)]
    fn turn_implicitly(&self, sticks: &mut [LoneStick]) -> f32 {
        let last = sticks.len() - 1;
        let mut a = self.position(0);
        let (mut pull_up, mut direction_up, mut stiffness_up) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        let (mut across_up, mut upper_up) = (Vec3::ZERO, 0.0);
        for (i, stick) in sticks.iter_mut().enumerate() {
            let w = self.inverse_mass(i);
            let (mut b, mut pull, mut direction, mut stiffness) = (a, Vec3::ZERO, Vec3::ZERO, 0.0);
            if i < last {
                b = self.position(i + 1);
                let delta = b - a;
                (pull, direction, stiffness) =
                    (delta * stick.right, delta * stick.scale, stick.right.max(0.0));
            }
            let force = pull - pull_up;
            let line = direction + direction_up;
            let along = line * (line.dot(force) / line.dot(line).max(f32::MIN_POSITIVE));
            let (lower, next) = (w * stiffness_up, w * stiffness);
            let inverse = 1.0 / (1.0 + next + lower * (1.0 - upper_up));
            let across = ((force - along) * w + across_up * lower) * inverse;
            let upper = next * inverse;
            stick.turn = LoneTurn { step: along * w, across, upper };
            (a, pull_up, direction_up, stiffness_up) = (b, pull, direction, stiffness);
            (across_up, upper_up) = (across, upper);
        }
        let (mut across, mut step_below, mut greatest) = (Vec3::ZERO, Vec3::ZERO, 0.0_f32);
        for (i, LoneStick { turn, .. }) in sticks.iter_mut().enumerate().rev() {
            across = turn.across + across * turn.upper;
            turn.step += across;
            if i < last {
                greatest = greatest.max((step_below - turn.step).length_squared());
            }
            step_below = turn.step;
        }
        greatest
    }

    #[inline(always)]
    fn apply(&mut self, sticks: &[LoneStick], part: f32) {
        let mut a = self.position(0);
        let mut pull_up = Vec3::ZERO;
        for (i, stick) in sticks.iter().enumerate() {
            let (mut b, mut pull) = (a, Vec3::ZERO);
            if i + 1 < sticks.len() {
                b = self.position(i + 1);
                pull = (b - a) * stick.right;
            }
            self.set_position(i, a + (pull - pull_up) * (self.inverse_mass(i) * part));
            (a, pull_up) = (b, pull);
        }
    }

    #[inline(always)]
    fn sweep(&mut self, part: f32, stick: ElasticStick, projection: impl Projection) {
        let count = self.slots.len() - 1;
        for i in (0..count).step_by(2).chain((1..count).step_by(2)) {
            let (p, q) = (self.position(i), self.position(i + 1));
            let (wa, wb) = (self.inverse_mass(i), self.inverse_mass(i + 1));
            let delta = q - p;
            let weight = (wa + wb).max(LEAST_WEIGHT) + self.compliance(i, stick);
            let scale = projection.error(delta.length_squared(), stick.rest) * part / weight;
            self.set_position(i, p + delta * (scale * wa));
            self.set_position(i + 1, q - delta * (scale * wb));
        }
    }

    /// The compliance of the stick below particle `i`.
    #[inline(always)]
    fn compliance(&self, i: usize, stick: ElasticStick) -> f32 {
        self.softness.map_or(stick.compliance, |softness| stick.compliance * softness[i])
    }

    #[inline(always)]
    fn position(&self, i: usize) -> Vec3 {
        let slot = self.slots[i] as usize;
        self.position[slot / LANES].get(slot % LANES)
    }

    #[inline(always)]
    fn set_position(&mut self, i: usize, position: Vec3) {
        let slot = self.slots[i] as usize;
        self.position[slot / LANES].set(slot % LANES, position);
    }

    #[inline(always)]
    fn inverse_mass(&self, i: usize) -> f32 {
        let slot = self.slots[i] as usize;
        self.inverse_mass[slot / LANES][slot % LANES].min(GREATEST_INVERSE_MASS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::direct::testing::{RIGID, SOFT, Solve, chains, lane_of, softness, width_share};
    use crate::constraint::projection::Exact;
    use crate::simd::isa::Isa;
    use crate::simd::miri::unless_miri;

    fn bits(cells: &[Cell]) -> Vec<u32> {
        cells.iter().flat_map(|cell| cell.axes().map(|axis| axis.map(f32::to_bits))).flatten().collect()
    }

    /// The scalar form, which ropes run: short and long steps, to the bit. The long steps of rigid sticks are those of sticks that are too
    /// short: from 5 % of stretch on ropes ease by another rule than lines of cloth.
    #[test]
    fn each_lane_does_what_a_lone_chain_does() {
        let cases = [(0.02, 1.0, RIGID), (1.0, 0.5, RIGID), (0.02, 1.0, SOFT), (1.0, 1.0, SOFT)];
        for ((stretched, size, stick), is_torn) in
            cases.into_iter().flat_map(|case| [(case, false), (case, true)])
        {
            for count in [2, 3, unless_miri(40, 5)] {
                let softness = softness(count);
                let (mut position, inverse_mass) = chains(count, stretched);
                for cell in &mut position {
                    (0..LANES).for_each(|lane| cell.set(lane, cell.get(lane) * size));
                }
                let mut lone = position.clone();
                let mut sticks = vec![LoneStick::default(); count];
                for lane in 0..LANES {
                    let slots: Vec<u32> = lane_of(count, |cell| (cell * LANES + lane) as u32);
                    let compliance = stick.compliance / width_share(lane) as f32;
                    let of_lane: Vec<f32> = softness.iter().map(|softness| softness[lane]).collect();
                    let softness = is_torn.then_some(&*of_lane);
                    LoneChain { position: &mut lone, inverse_mass: &inverse_mass, slots: &slots, softness }
                        .solve(&mut sticks, ElasticStick { compliance, ..stick }, Exact);
                }
                Isa::detected().run(Solve {
                    position: &mut position,
                    inverse_mass: &inverse_mass,
                    count,
                    gaps: None,
                    softness: is_torn.then_some(&*softness),
                    stick,
                });
                assert!(bits(&position) == bits(&lone), "{count} particles, {stretched}, {stick:?}");
            }
        }
    }

    /// The width of a gap is no strain: both parts of a chain in the lanes move as they do alone.
    #[test]
    fn a_chain_with_a_wide_gap_moves_as_its_two_parts() {
        const COUNT: usize = 8;
        let gap = COUNT / 2;
        let (mut position, inverse_mass) = chains(COUNT, 0.02);
        for cell in &mut position[1 + 2 * gap..] {
            (0..LANES).for_each(|lane| cell.set(lane, cell.get(lane) + Vec3::ONE));
        }
        let before = position.clone();
        let mut apart = position.clone();
        for lane in 0..LANES {
            let slots: Vec<u32> = lane_of(COUNT, |cell| (cell * LANES + lane) as u32);
            let (first, second) = slots.split_at(gap);
            for slots in [first, second] {
                let mut chain =
                    LoneChain { position: &mut apart, inverse_mass: &inverse_mass, slots, softness: None };
                chain.solve(&mut [LoneStick::default(); COUNT], RIGID, Exact);
            }
        }
        let gaps: Vec<u16> = (0..COUNT).map(|i| if i + 1 == gap { u16::MAX } else { 0 }).collect();
        Isa::detected().run(Solve {
            position: &mut position,
            inverse_mass: &inverse_mass,
            count: COUNT,
            gaps: Some(&gaps),
            softness: None,
            stick: RIGID,
        });
        assert!(position != before, "something moves");
        assert!(bits(&position) == bits(&apart));
    }
}
