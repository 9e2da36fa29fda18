//! The place and the direction that a camera looks from.

use bevy::prelude::*;

#[cfg(feature = "window")]
use crate::view::orbit::Orbit;

/// The place of a camera, and its vertical angle of view in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// The place of the camera.
    pub eye: Vec3,
    /// The point that the camera looks at, in metres.
    pub target: Vec3,
    /// Vertical angle of view in radians.
    pub field_of_view: f32,
}

impl Viewpoint {
    /// The same as a camera that circles about what it looks at.
    #[cfg(feature = "window")]
    pub fn orbit(&self) -> Orbit {
        let offset = self.eye - self.target;
        let distance = offset.length().max(0.1);
        let pitch = (offset.y / distance).clamp(-1.0, 1.0).asin();
        Orbit { target: self.target, yaw: offset.x.atan2(offset.z), pitch, distance }
    }

    /// Puts a camera there.
    pub fn apply(&self, transform: &mut Transform, projection: &mut Projection) {
        *transform = Transform::from_translation(self.eye).looking_at(self.target, Vec3::Y);
        if let Projection::Perspective(perspective) = projection {
            perspective.fov = self.field_of_view;
        }
    }
}
