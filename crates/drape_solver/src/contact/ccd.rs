//! Continuous collision detection: corners that pass faces, and edges that pass edges, within a substep.
//!
//! A corner passes a face, or an edge an edge, at the moment when the four corners lie in one plane. All corners are
//! taken to move along straight lines at constant speed, and the signed height of one part above the other to change
//! linearly:
//!
//! ```text
//!   o start   height above zero          the normal is taken at the place of passing, and points
//!    \                                   to the side of the start
//!   --x------ face, at the fraction h / (h - h') of the way
//!      \
//!       o now   height h' below zero
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::geometry::nearest_segments::between_segments;
use crate::geometry::nearest_triangle::on_triangle;

/// Four corners at the start of a substep, and now.
pub(crate) struct Passage {
    pub start: [Vec3; 4],
    pub now: [Vec3; 4],
}

impl Passage {
    fn at(&self, fraction: f32) -> [Vec3; 4] {
        core::array::from_fn(|k| self.start[k] + (self.now[k] - self.start[k]) * fraction)
    }

    /// The corners at the moment of passing and the sign of the height before, if the sign changes. The height leads
    /// from the corner at `foot` to the first corner, along a `normal` of any length.
    #[inline]
    fn passing(&self, normal: impl Fn(&[Vec3; 4]) -> Vec3, foot: usize) -> Option<([Vec3; 4], f32)> {
        let normals = [normal(&self.start), normal(&self.now)];
        let above = |p: &[Vec3; 4], normal: Vec3| normal.dot(p[0] - p[foot]);
        let (before, after) = (above(&self.start, normals[0]), above(&self.now, normals[1]));
        if before * after >= 0.0 {
            return None;
        }
        self.at_sign_change(before / normals[0].length(), after / normals[1].length())
    }

    /// The corners at the moment when a height changes its sign between the start and now, and its sign before.
    #[inline]
    pub fn at_sign_change(&self, before: f32, after: f32) -> Option<([Vec3; 4], f32)> {
        (before * after < 0.0).then(|| (self.at(before / (before - after)), before.signum()))
    }
}

/// Weights and unit normal of the place at which the first corner has passed through the face of the others, or beside
/// it by at most `slack` metres.
pub(crate) fn face_passed(passage: &Passage, slack: f32) -> Option<([f32; 4], Vec3)> {
    let normal = |p: &[Vec3; 4]| (p[2] - p[1]).cross(p[3] - p[1]);
    let (p, sign) = passage.passing(normal, 1)?;
    let [u, v, w] = on_triangle([p[1], p[2], p[3]], p[0]);
    let beside = p[0] - (p[1] * u + p[2] * v + p[3] * w);
    (beside.length_squared() <= slack * slack)
        .then(|| ([1.0, -u, -v, -w], normal(&p).normalize_or_zero() * sign))
}

/// The same for two edges: that of the first two corners and that of the last two.
pub(crate) fn edges_passed(passage: &Passage, slack: f32) -> Option<([f32; 4], Vec3)> {
    let normal = |p: &[Vec3; 4]| (p[1] - p[0]).cross(p[3] - p[2]);
    let (p, sign) = passage.passing(normal, 2)?;
    // Edges that only turn past each other's direction change the sign without passing.
    if normal(&passage.start).dot(normal(&passage.now)) <= 0.0 {
        return None;
    }
    let [s, t] = between_segments([p[0], p[1]], [p[2], p[3]]);
    let beside = p[0].lerp(p[1], s) - p[2].lerp(p[3], t);
    (beside.length_squared() <= slack * slack)
        .then(|| ([1.0 - s, s, t - 1.0, -t], normal(&p).normalize_or_zero() * sign))
}
