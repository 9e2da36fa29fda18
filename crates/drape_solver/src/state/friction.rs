//! Coulomb friction at the level of positions.
//!
//! Jakobsen 2001: friction reduces the tangential displacement by at most `mu` times the penetration depth that the
//! projections removed, and never reverses it. On an incline a particle sinks `g cos(theta) h^2` in a substep and
//! slides `g sin(theta) h^2`: it stays where `tan(theta) < mu`, which is Coulomb's law exactly.
//!
//! A contact sticks if static friction can stop it within the substep; otherwise it slides against kinetic friction.
//!
//! `Friction::slip_taken` is the rule. `ObstacleRows::apply_friction` (`contact/particle_obstacle.rs`) repeats it in
//! lanes, for particles on obstacles that nothing pushes: change both. All other contacts call it.
//!
//! Design: `docs/design/contacts.md`.

use glam::Vec3;

use crate::state::combine_rule::CombineRule;

/// The friction of a surface, or of two in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Friction {
    /// Coefficient of kinetic friction.
    pub kinetic: f32,
    /// Coefficient of static friction, at least the kinetic one.
    pub sticking: f32,
}

impl Friction {
    /// Friction with these coefficients; a static one below the kinetic one counts as that.
    pub fn new(kinetic: f32, sticking: f32) -> Self {
        Self { kinetic, sticking: sticking.max(kinetic) }
    }

    /// Friction between two surfaces that have no rule of their own.
    pub fn with(self, other: Self) -> Self {
        self.with_by(other, CombineRule::default())
    }

    /// Friction between two surfaces by a rule, for each coefficient.
    pub fn with_by(self, other: Self, rule: CombineRule) -> Self {
        Self {
            kinetic: rule.combine(self.kinetic, other.kinetic),
            sticking: rule.combine(self.sticking, other.sticking),
        }
    }

    /// The same for slips that are `factor` times the displacement of a mass point under the same push.
    pub fn scaled(self, factor: f32) -> Self {
        Self { kinetic: self.kinetic * factor, sticking: self.sticking * factor }
    }

    /// The share of a tangential push that the contact passes on if it is pressed by `normal_push`, in the same unit: all of it, or
    /// as much as kinetic friction bears.
    pub fn share_of(self, push: f32, normal_push: f32) -> f32 {
        if push <= self.sticking * normal_push { 1.0 } else { self.kinetic * normal_push / push }
    }

    /// The part of the relative displacement `slip` that friction removes, for a contact of summed `depth` (metres)
    /// along `normal`.
    pub fn slip_taken(self, slip: Vec3, normal: Vec3, depth: f32) -> Vec3 {
        let tangential = slip - normal * slip.dot(normal);
        let length = tangential.length();
        if length <= self.sticking * depth {
            tangential
        } else {
            tangential * (self.kinetic * depth / length)
        }
    }
}
