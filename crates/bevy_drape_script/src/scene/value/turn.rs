//! Rotations.

use bevy::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Number, Vector};

/// A rotation about an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Turn {
    /// The axis, of any length but zero; (0, 1, 0), upwards, by default.
    pub axis: Vector,
    /// The angle in degrees, counter-clockwise as seen from the tip of the axis; 0 by default.
    pub degrees: Number,
}

impl Default for Turn {
    fn default() -> Self {
        Self { axis: Vector::known(Vec3::Y), degrees: Number::known(0.0) }
    }
}

impl Turn {
    /// The rotation as a quaternion, with equal bits on every machine. An axis without length gives the identity.
    pub fn quaternion(&self) -> Quat {
        let half = f64::from(self.degrees.get()).to_radians() * 0.5;
        let axis = self.axis.as_dvec3();
        let length = (axis.x * axis.x + axis.y * axis.y + axis.z * axis.z).sqrt();
        if half == 0.0 || length == 0.0 {
            return Quat::IDENTITY;
        }
        let (sine, cosine) = (libm::sin(half) / length, libm::cos(half));
        Quat::from_xyzw((axis.x * sine) as f32, (axis.y * sine) as f32, (axis.z * sine) as f32, cosine as f32)
    }

    /// Interpolates the angle from this turn (`part` 0) to `to` (`part` 1), about the axis of `to`.
    pub(crate) fn towards(&self, to: &Self, part: f32) -> Self {
        let [from, end] = [self, to].map(|turn| turn.degrees.get());
        Self { axis: to.axis, degrees: Number::known(from + (end - from) * part) }
    }
}
