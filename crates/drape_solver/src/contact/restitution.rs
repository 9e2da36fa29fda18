//! Restitution: how fast two part again after they have met.
//!
//! A projection leaves two surfaces touching at the end of the substep in which they met. What bounces has moved away
//! again by then, for the part of the substep that was left:
//!
//! ```text
//!   gap  \           .             approach   a : displacement towards each other in a substep
//!         \        .  e a (1 - f)  fraction   f : part of the substep after which they met
//!   ------\------.---------- 0     rebound  e a : displacement apart, from then on
//!          \   f  1
//! ```
//!
//! so that neither loses the rest of its step. Restitution is Newton's: the ratio of the normal speeds after and before.

use crate::constants::RESTITUTION_SPEED;
use crate::state::friction::combined;

/// How two met in a substep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impact {
    /// Displacement towards each other in the substep, metres; 0 if they have not met.
    approach: f32,
    /// Part of the substep after which they met.
    fraction: f32,
}

/// What a rebound adds, in metres along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rebound {
    /// Displacement apart, per substep, that they are to have.
    pub displacement: f32,
    /// How far apart they are by the end of this substep.
    pub position: f32,
}

impl Impact {
    /// Notes the first projection of a substep: `gap_change` (metres) is what the gap has changed by in it so far, and
    /// `fraction` the part of it after which the surfaces met.
    pub fn note(&mut self, gap_change: f32, fraction: f32) {
        if self.approach == 0.0 {
            *self = Self { approach: (-gap_change).max(0.0), fraction };
        }
    }

    /// How they part, if they do: surfaces with these coefficients (the mean counts), in a `substep` of so many seconds.
    pub fn rebound(self, [first, second]: [f32; 2], substep: f32) -> Option<Rebound> {
        let restitution = combined(first, second);
        let displacement = restitution * self.approach;
        (restitution > 0.0 && self.approach > RESTITUTION_SPEED * substep)
            .then_some(Rebound { displacement, position: displacement * (1.0 - self.fraction) })
    }
}
