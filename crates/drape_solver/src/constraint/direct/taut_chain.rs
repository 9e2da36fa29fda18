//! Chains under tension, which also turn: the second half of the implicit step of a [chain](crate::constraint::direct::chain).
//!
//! ```text
//!        x1                  a particle that leaves the line by y is pulled back by the pulls of both its sticks:
//!   o---.o.---o  pull          m y'' = - (pull_0 / length_0 + pull_1 / length_1) y + ...
//!   x0        x2             a spring across the line, the geometric stiffness of the chain
//! ```
//!
//! The multipliers of a chain take its sticks as straight. Each multiplier then moves the particles across the line by the turn that
//! the stick has now, which is an explicit step of that spring: where `w pull h^2 / length` is above 1, or 0.5 if rows and columns pull alike, the
//! shortest waves grow until the chain hums, or stretches. So the moves across the line are solved implicitly, `(1 / w + L) y = pull across`, where `L` has the pulls
//! over lengths (Tournier, Nesme, Gilles and Faure 2015, "Stable Constrained Dynamics", equation 12). The matrix has three diagonals.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::constraint::direct::chain::{ChainScratch, Chains};
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load};

/// Scratch of a particle.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct ChainTurn {
    /// Its move along the line; its whole move on the way up.
    step: Cell,
    /// Its move across the line, but for the part that follows from the next particle's.
    across: Cell,
    /// Factor of the next particle's move across the line.
    upper: [f32; LANES],
}

impl Chains<'_> {
    /// Finds the moves of the particles, from the multipliers of their sticks. Returns the square of the greatest move of a stick's two
    /// ends against each other.
    #[inline(always)]
    pub(super) fn turn_implicitly<S: Simd>(&self, simd: S, scratch: &mut ChainScratch) -> f32x16<S> {
        let ChainScratch { sticks, turns } = scratch;
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let none = Lanes3 { x: zero, y: zero, z: zero };
        let least = f32x16::splat(simd, f32::MIN_POSITIVE);
        let mut a = self.position(simd, 0);
        // Of the stick above: pull, direction, and pull over length; of the particle above: its unfinished move and its factor.
        let (mut pull_up, mut direction_up, mut stiffness_up) = (none, none, zero);
        let (mut across_up, mut upper_up) = (none, zero);
        for (i, turn) in turns[..self.count].iter_mut().enumerate() {
            let w = self.inverse_mass(simd, i);
            let (mut b, mut pull, mut direction, mut stiffness) = (a, none, none, zero);
            if i + 1 < self.count {
                let stick = &sticks[i];
                b = self.position(simd, i + 1);
                let delta = b.minus(a);
                pull = delta.times(load(simd, &stick.right));
                direction = delta.times(load(simd, &stick.scale));
                // A stick that pushes would bend out: it has no stiffness across.
                stiffness = load(simd, &stick.right).max(zero);
            }
            let force = pull.minus(pull_up);
            let line = direction.plus(direction_up);
            let along = line.times(line.dot(force) / line.dot(line).max(least));
            along.times(w).store(&mut turn.step);
            let lower = w * stiffness_up;
            let next = w * stiffness;
            let inverse = one / (one + next + lower * (one - upper_up));
            let across = force.minus(along).times(w).plus(across_up.times(lower)).times(inverse);
            let upper = next * inverse;
            across.store(&mut turn.across);
            turn.upper = upper.to_array();
            (a, pull_up, direction_up, stiffness_up) = (b, pull, direction, stiffness);
            (across_up, upper_up) = (across, upper);
        }
        let (mut across, mut step_below, mut greatest) = (none, none, zero);
        for (i, turn) in turns[..self.count].iter_mut().enumerate().rev() {
            across = Lanes3::load(simd, &turn.across).plus(across.times(load(simd, &turn.upper)));
            let step = Lanes3::load(simd, &turn.step).plus(across);
            step.store(&mut turn.step);
            if i + 1 < self.count {
                let turned = step_below.minus(step);
                greatest = greatest.max(turned.dot(turned));
            }
            step_below = step;
        }
        greatest
    }

    /// Moves each particle of the lanes in `is_taut` by `part` of what [`turn_implicitly`](Self::turn_implicitly) has found.
    #[inline(always)]
    pub(super) fn apply_turns<S: Simd>(
        &mut self,
        simd: S,
        scratch: &ChainScratch,
        part: f32x16<S>,
        is_taut: mask32x16<S>,
    ) {
        for (i, turn) in scratch.turns[..self.count].iter().enumerate() {
            let before = self.position(simd, i);
            let after = before.plus(Lanes3::load(simd, &turn.step).times(part));
            self.set_position(i, after.or(is_taut, before));
        }
    }
}
