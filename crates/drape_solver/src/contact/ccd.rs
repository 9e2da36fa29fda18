//! Continuous collision detection: what passes something else within a substep.
//!
//! A point passes a face at the moment when it lies in the plane of the face. All corners are taken to move along straight
//! lines at constant speed, and the signed height of the point above the face to change linearly:
//!
//! ```text
//!   o start   height above zero          the place of passing lies at the fraction
//!    \                                   h / (h - h') of the way
//!   --x------ face
//!      \
//!       o now   height h' below zero
//! ```
//!
//! Design: `docs/design/ball_cloth.md`.

use glam::Vec3;

/// Four corners at the start of a substep, and now.
pub(crate) struct Passage {
    pub start: [Vec3; 4],
    pub now: [Vec3; 4],
}

impl Passage {
    fn at(&self, fraction: f32) -> [Vec3; 4] {
        core::array::from_fn(|k| self.start[k] + (self.now[k] - self.start[k]) * fraction)
    }

    /// The corners at the moment when a height changes its sign between the start and now, and its sign before.
    #[inline]
    pub fn at_sign_change(&self, before: f32, after: f32) -> Option<([Vec3; 4], f32)> {
        (before * after < 0.0).then(|| (self.at(before / (before - after)), before.signum()))
    }
}
