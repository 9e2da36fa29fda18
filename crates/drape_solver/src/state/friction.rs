//! Coulomb friction at the level of positions.
//!
//! Jakobsen 2001: reduce the tangential displacement by at most `mu` times the penetration depth that the
//! projections took out, and never reverse it. On an incline a particle sinks `g cos(theta) h^2` in a substep
//! and slides `g sin(theta) h^2`: it stays where `tan(theta) < mu`, which is Coulomb's law exactly.
//!
//! What static friction can stop within the substep sticks; what is faster slides, against kinetic friction alone.

use glam::Vec3;

/// The friction of a surface, or of two in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Friction {
    /// Coefficient against what slides.
    pub kinetic: f32,
    /// Coefficient against what sticks; at least the other.
    pub sticking: f32,
}

impl Friction {
    /// From a coefficient of kinetic friction, and one of static friction that counts if it is greater.
    pub fn new(kinetic: f32, sticking: f32) -> Self {
        Self { kinetic, sticking: sticking.max(kinetic) }
    }

    /// Of two surfaces: the mean of each coefficient.
    pub fn with(self, other: Self) -> Self {
        Self {
            kinetic: combined(self.kinetic, other.kinetic),
            sticking: combined(self.sticking, other.sticking),
        }
    }

    /// For slips that are `factor` times as long as the displacement of a mass point under the same push.
    pub fn scaled(self, factor: f32) -> Self {
        Self { kinetic: self.kinetic * factor, sticking: self.sticking * factor }
    }

    /// The part of the relative displacement `slip` that friction takes, given the summed `depth` (metres) of
    /// the contact along `normal`: to be subtracted.
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

/// The coefficients of two surfaces combined: their mean.
pub(crate) fn combined(a: f32, b: f32) -> f32 {
    0.5 * (a + b)
}
