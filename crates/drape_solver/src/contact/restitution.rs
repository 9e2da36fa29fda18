//! Restitution: the speed at which two move apart after an impact.
//!
//! A projection leaves two surfaces touching at the end of the substep in which they met. A body that bounces has
//! already moved away again by then, for the rest of the substep:
//!
//! ```text
//!   gap  \           .             approach   a : displacement towards each other in a substep
//!         \        .  e a (1 - f)  fraction   f : part of the substep after which they met
//!   ------\------.---------- 0     rebound  e a : displacement apart, from then on
//!          \   f  1
//! ```
//!
//! so that neither loses the rest of its step. Restitution is Newton's: the ratio of the normal speeds after and before.
//!
//! Design: `docs/design/contacts.md`.

use crate::constants::RESTITUTION_SPEED;

/// The impact of two in a substep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impact {
    /// Displacement towards each other in the substep, metres; 0 if they have not met.
    approach: f32,
    /// Part of the substep after which they met.
    fraction: f32,
}

/// The displacements of a rebound, in metres along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rebound {
    /// Displacement apart per substep after the rebound.
    pub displacement: f32,
    /// Distance apart at the end of this substep.
    pub position: f32,
}

impl Impact {
    /// Records the first projection of a substep. `gap_change` (metres) is the change of the gap in the substep so far,
    /// `fraction` the part of the substep after which the surfaces met.
    pub fn note(&mut self, gap_change: f32, fraction: f32) {
        if self.approach == 0.0 {
            *self = Self { approach: (-gap_change).max(0.0), fraction };
        }
    }

    /// The rebound of two with this coefficient between them, in a `substep` of so many seconds; none if they do not
    /// bounce.
    pub fn rebound(self, restitution: f32, substep: f32) -> Option<Rebound> {
        let displacement = restitution * self.approach;
        (restitution > 0.0 && self.approach > RESTITUTION_SPEED * substep)
            .then_some(Rebound { displacement, position: displacement * (1.0 - self.fraction) })
    }
}
