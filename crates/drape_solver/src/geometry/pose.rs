//! Poses of obstacles: translation and rotation, in scalar code.
//!
//! The rotation is computed here and not by `Quat`, whose products depend on the instruction set that glam was compiled
//! for: the step must give the same bits everywhere.
//!
//! Design: `docs/design/determinism.md`.

use glam::{Mat3, Quat, Vec3};

/// A rigid transform, ready to apply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    rotation: Mat3,
    translation: Vec3,
}

impl Pose {
    /// The pose of something at `placement`, relative to `origin`.
    pub fn at(placement: &Placement, origin: Vec3) -> Self {
        Self::between(placement, placement, 1.0, origin)
    }

    /// The pose between `from` and `to` at `fraction` of the way, relative to `origin`.
    pub fn between(from: &Placement, to: &Placement, fraction: f32, origin: Vec3) -> Self {
        let blend = |a: f32, b: f32| a + (b - a) * fraction;
        let (p, q) = (from.rotation.to_array(), to.rotation.to_array());
        // Opposite quaternions are the same rotation: take the nearer one.
        let dot: f32 = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
        let sign = if dot < 0.0 { -1.0 } else { 1.0 };
        let rotation = [0, 1, 2, 3].map(|k| blend(p[k], sign * q[k]));
        let translation = Vec3::new(
            blend(from.translation.x, to.translation.x),
            blend(from.translation.y, to.translation.y),
            blend(from.translation.z, to.translation.z),
        );
        Self { rotation: rotation_matrix(rotation), translation: translation - origin }
    }

    /// The axes of the rotation, and the translation.
    pub fn parts(&self) -> ([Vec3; 3], Vec3) {
        ([self.rotation.x_axis, self.rotation.y_axis, self.rotation.z_axis], self.translation)
    }

    /// The pose with the same rotation, elsewhere.
    pub fn moved_to(self, translation: Vec3) -> Self {
        Self { translation, ..self }
    }

    /// Least and greatest corner, in the world, of a local box.
    pub fn bounds_of(self, middle: Vec3, half_extents: Vec3) -> (Vec3, Vec3) {
        let (r, half) = (&self.rotation, half_extents);
        let reach = (r.x_axis * half.x).abs() + (r.y_axis * half.y).abs() + (r.z_axis * half.z).abs();
        let centre = self.point_to_world(middle);
        (centre - reach, centre + reach)
    }

    pub fn to_local(self, point: Vec3) -> Vec3 {
        self.direction_to_local(point - self.translation)
    }

    pub fn direction_to_local(self, direction: Vec3) -> Vec3 {
        let r = &self.rotation;
        Vec3::new(r.x_axis.dot(direction), r.y_axis.dot(direction), r.z_axis.dot(direction))
    }

    pub fn point_to_world(self, local: Vec3) -> Vec3 {
        self.direction_to_world(local) + self.translation
    }

    pub fn direction_to_world(self, local: Vec3) -> Vec3 {
        let r = &self.rotation;
        r.x_axis * local.x + r.y_axis * local.y + r.z_axis * local.z
    }
}

/// Translation in metres and rotation of an obstacle in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Position in metres.
    pub translation: Vec3,
    /// Rotation; need not be normalised.
    pub rotation: Quat,
}

impl Default for Placement {
    fn default() -> Self {
        Self { translation: Vec3::ZERO, rotation: Quat::IDENTITY }
    }
}

impl Placement {
    /// At `translation` (metres), not rotated.
    pub fn at(translation: Vec3) -> Self {
        Self { translation, ..Self::default() }
    }

    /// True if all components are finite and the rotation is not zero.
    pub fn is_valid(&self) -> bool {
        self.translation.is_finite() && self.rotation.is_finite() && self.rotation.to_array() != [0.0; 4]
    }
}

/// The matrix of a quaternion (x, y, z, w) of any length above zero.
fn rotation_matrix([x, y, z, w]: [f32; 4]) -> Mat3 {
    let length_squared = x * x + y * y + z * z + w * w;
    let s = if length_squared > 0.0 { 2.0 / length_squared } else { 0.0 };
    Mat3::from_cols(
        Vec3::new(1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
        Vec3::new(s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)),
        Vec3::new(s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)),
    )
}

/// `rotation` turned by the small rotation vector `turn` (radians, world axes), normalised again.
pub(crate) fn turned(rotation: Quat, turn: Vec3) -> Quat {
    let [x, y, z, w] = rotation.to_array();
    let Vec3 { x: tx, y: ty, z: tz } = turn * 0.5;
    let next = [
        x + tx * w + ty * z - tz * y,
        y + ty * w + tz * x - tx * z,
        z + tz * w + tx * y - ty * x,
        w - tx * x - ty * y - tz * z,
    ];
    let length = (next[0] * next[0] + next[1] * next[1] + next[2] * next[2] + next[3] * next[3]).sqrt();
    Quat::from_array(next.map(|component| component / length))
}

/// The rotation vector (radians, world axes) of the shorter turn from one rotation to another. Halves the turn until
/// its sine is its angle: a quaternion plus the identity points along half the angle, which takes roots only.
pub(crate) fn turn_between(from: Quat, to: Quat) -> Vec3 {
    if from == to {
        return Vec3::ZERO;
    }
    let way = to * from.conjugate();
    let mut part = (if way.w < 0.0 { -way } else { way }).normalize();
    for _ in 0..HALVINGS {
        part = (part + Quat::IDENTITY).normalize();
    }
    part.xyz() * (2.0 * f32::from(1_u8 << HALVINGS))
}

/// A sixteenth of half a turn differs from its sine by less than one part in 150.
const HALVINGS: u8 = 4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;

    #[test]
    fn a_turn_between_two_rotations_leads_from_one_to_the_other() {
        let from = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
        for axis in [Vec3::X, Vec3::new(0.6, -0.8, 0.0), Vec3::new(1.0, 2.0, -2.0) / 3.0] {
            for angle in [1e-3, 0.1, 1.0, 2.0, 3.1] {
                let turn = turn_between(from, Quat::from_axis_angle(axis, angle) * from);
                assert!(
                    (turn - axis * angle).length() < 0.007 * angle + 1e-6,
                    "{angle} about {axis}: {turn}"
                );
            }
        }
        assert_eq!(turn_between(from, from), Vec3::ZERO);
    }

    #[test]
    fn pose_agrees_with_the_quaternion_and_inverts() {
        let rotation = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
        let placement = Placement { translation: Vec3::new(1.0, 2.0, 3.0), rotation: rotation * 3.0 };
        let pose = Pose::at(&placement, Vec3::ZERO);
        let local = Vec3::new(-0.5, 0.25, 4.0);
        let world = pose.point_to_world(local);
        assert!((world - (rotation * local + placement.translation)).length() < 1e-5);
        assert!((pose.to_local(world) - local).length() < 1e-5);
    }

    #[test]
    fn small_turns_add_up_to_a_whole_one() {
        let mut rotation = Quat::IDENTITY;
        let steps = unless_miri(10_000, 500);
        for _ in 0..steps {
            rotation = turned(rotation, Vec3::Y * (core::f32::consts::TAU / steps as f32));
        }
        assert!((rotation * Vec3::X - Vec3::X).length() < 1e-3);
    }
}
