//! A moving frame of reference as data: the part of its wearer's motion that a cloth does not feel.
//!
//! A cape on a character that runs, jumps and turns would feel all of that motion and fly like a flag. To calm it, a
//! share of the character's motion becomes the motion of the cape's frame. The frame carries the cape along, and the
//! cape's velocity is relative to the frame. `motion/moving_frame.rs` carries the particles.
//!
//! Design: `docs/design/characters.md`.

use glam::{Mat3, Vec3};

use crate::geometry::pose::{Placement, Pose};
use crate::simd::columns::LANES;
use crate::state::particles::Particles;

/// A rigid motion: a turn, and then a translation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameMotion {
    /// Centre of the turn in the world, in metres.
    pub pivot: Vec3,
    /// Axis of the turn times its angle in radians.
    pub turn: Vec3,
    /// Metres.
    pub translation: Vec3,
}

impl FrameMotion {
    /// The motion that takes something from one place to another, by the shorter turn.
    pub fn between(from: &Placement, to: &Placement) -> Self {
        let ([ax, ay, az, aw], [bx, by, bz, bw]) = (from.rotation.to_array(), to.rotation.to_array());
        // `to` times the conjugate of `from`.
        let w = bw * aw + bx * ax + by * ay + bz * az;
        let axis = Vec3::new(
            bx * aw - bw * ax + bz * ay - by * az,
            by * aw - bw * ay + bx * az - bz * ax,
            bz * aw - bw * az + by * ax - bx * ay,
        );
        let length = axis.length();
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        let angle = 2.0 * libm::atan2f(length, w * sign);
        let turn = if length > 0.0 { axis * (sign * angle / length) } else { Vec3::ZERO };
        Self { pivot: from.translation, turn, translation: to.translation - from.translation }
    }

    /// A part of the motion: of the translation, and of the turn.
    pub fn scaled(self, linear: f32, angular: f32) -> Self {
        Self { turn: self.turn * angular, translation: self.translation * linear, ..self }
    }

    /// True if the motion is the identity.
    pub fn is_rest(&self) -> bool {
        self.turn == Vec3::ZERO && self.translation == Vec3::ZERO
    }

    /// True if all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.pivot.is_finite() && self.turn.is_finite() && self.translation.is_finite()
    }

    /// Upper bound in metres on the path of any point in a box.
    pub(crate) fn reach(&self, (low, high): (Vec3, Vec3)) -> f32 {
        let farthest = (self.pivot - low).abs().max((high - self.pivot).abs());
        self.translation.length() + self.turn.length() * farthest.length()
    }

    /// The matrix `R - I` of the rotation by a part of the angle, in a form that is exact for small angles (Rodrigues).
    fn added(&self, part: f32) -> Mat3 {
        let angle = self.turn.length();
        if angle == 0.0 {
            return Mat3::ZERO;
        }
        let Vec3 { x, y, z } = self.turn / angle;
        let half = libm::sinf(angle * part * 0.5);
        let (s, c) = (libm::sinf(angle * part), 2.0 * half * half);
        Mat3::from_cols(
            Vec3::new(-c * (y * y + z * z), s * z + c * x * y, c * x * z - s * y),
            Vec3::new(c * x * y - s * z, -c * (x * x + z * z), s * x + c * y * z),
            Vec3::new(s * y + c * x * z, c * y * z - s * x, -c * (x * x + y * y)),
        )
    }
}

/// The part of a motion that falls to each substep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SubstepMotion {
    /// The matrix `R - I` of the turn, by which an offset from the pivot changes.
    pub added: Mat3,
    pub translation: Vec3,
    /// Pivot at the start of the step, relative to the body's origin.
    pub pivot: Vec3,
}

impl SubstepMotion {
    pub fn new(motion: &FrameMotion, substeps: u32, origin: Vec3) -> Self {
        let part = 1.0 / substeps as f32;
        Self {
            added: motion.added(part),
            translation: motion.translation * part,
            pivot: motion.pivot - origin,
        }
    }
}

impl Particles {
    /// Moves the particles' frame of reference by `motion` in the next step, evenly over its substeps. Free particles
    /// are carried along and keep their velocities within the frame; pinned ones go to their
    /// [targets](Self::set_pin_target). The last of several motions in one step counts. A motion that is not finite
    /// counts as none.
    pub fn move_frame(&mut self, motion: FrameMotion) {
        self.frame = Some(motion).filter(|motion| motion.is_finite() && !motion.is_rest());
        if self.frame.is_some() {
            self.disturb();
        }
    }

    /// Moves the whole body rigidly from one placement to another at once. Pins, velocities, limits, backstops and drives
    /// turn with it, so nothing is pulled or thrown.
    pub fn teleport(&mut self, from: &Placement, to: &Placement) {
        if !(from.is_valid() && to.is_valid()) {
            return;
        }
        let [from, to] = [from, to].map(|place| Pose::between(place, place, 1.0, Vec3::ZERO));
        let new_origin = to.point_to_world(from.to_local(self.origin));
        let turn = |v: Vec3| to.direction_to_world(from.direction_to_local(v));
        for column in [&mut self.position, &mut self.displacement] {
            for slot in 0..column.cells.len() * LANES {
                column.set(slot, turn(column.get(slot)));
            }
        }
        self.pose.turn(turn);
        for (_, target) in &mut self.pin_targets {
            *target = to.point_to_world(from.to_local(*target));
        }
        self.origin = new_origin;
        self.disturb();
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn a_motion_in_parts_takes_things_where_the_whole_does() {
        let from = Placement {
            translation: Vec3::new(1.0, 2.0, 3.0),
            rotation: Quat::from_euler(glam::EulerRot::XYZ, 0.3, -0.4, 0.2),
        };
        let to = Placement {
            translation: Vec3::new(1.5, 2.0, 2.0),
            rotation: Quat::from_euler(glam::EulerRot::XYZ, -0.1, 0.9, 0.3) * -1.0,
        };
        let motion = FrameMotion::between(&from, &to);
        let (start, mut point) = (Vec3::new(4.0, -1.0, 0.5), Vec3::new(4.0, -1.0, 0.5));
        let parts = SubstepMotion::new(&motion, 10, Vec3::ZERO);
        for substep in 0..10 {
            let pivot = parts.pivot + parts.translation * substep as f32;
            point += parts.added * (point - pivot) + parts.translation;
        }
        let [from, to] = [from, to].map(|place| Pose::between(&place, &place, 1.0, Vec3::ZERO));
        let expected = to.point_to_world(from.to_local(start));
        assert!(point.distance(expected) < 1e-5, "{point} instead of {expected}");
        assert!(motion.reach((start, start)) >= point.distance(start));
    }

    #[test]
    fn no_motion_is_rest() {
        let place = Placement { translation: Vec3::Y, rotation: Quat::from_rotation_x(0.7) };
        assert!(FrameMotion::between(&place, &place).scaled(1.0, 1.0).translation == Vec3::ZERO);
        assert!(FrameMotion::default().is_rest());
        assert!(FrameMotion { turn: Vec3::X, ..FrameMotion::default() }.scaled(1.0, 0.0).is_rest());
    }
}
