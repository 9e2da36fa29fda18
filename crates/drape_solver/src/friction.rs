//! Coulomb friction at the level of positions.
//!
//! Jakobsen 2001: reduce the tangential displacement by at most `mu` times the penetration depth that the
//! projections took out, and never reverse it. On an incline a particle sinks `g cos(theta) h^2` in a substep
//! and slides `g sin(theta) h^2`: it stays where `tan(theta) < mu`, which is Coulomb's law exactly.

use glam::Vec3;

/// The two surfaces' coefficients combined: their mean.
pub(crate) fn combined(a: f32, b: f32) -> f32 {
    0.5 * (a + b)
}

/// The part of the relative displacement `slip` that friction takes, given the summed `depth` (metres) of
/// the contact along `normal`: to be subtracted.
pub(crate) fn slip_taken(slip: Vec3, normal: Vec3, coefficient: f32, depth: f32) -> Vec3 {
    let tangential = slip - normal * slip.dot(normal);
    let length = tangential.length();
    let most = coefficient * depth;
    if length <= most { tangential } else { tangential * (most / length) }
}
