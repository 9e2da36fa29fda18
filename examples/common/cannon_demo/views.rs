//! Places of the camera for pictures and the film.

use bevy::prelude::*;

/// A place of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position of the camera in metres.
    pub eye: Vec3,
    /// The point in the middle of the picture, in metres.
    pub target: Vec3,
}

impl View {
    /// The place of the camera, and where it looks.
    pub fn camera(self) -> Transform {
        Transform::from_translation(self.eye).looking_at(self.target, Vec3::Y)
    }
}

/// Behind the cannon.
pub const CANNON: View = View { eye: Vec3::new(-2.9, 2.1, 16.6), target: Vec3::new(0.25, 1.4, 6.0) };
/// In front of the curtain, from its right.
pub const RIGHT: View = View { eye: Vec3::new(4.4, 2.3, 5.4), target: Vec3::new(0.1, 1.6, 0.0) };
/// In front of the curtain, from its left.
pub const LEFT: View = View { eye: Vec3::new(-4.9, 2.2, 5.6), target: Vec3::new(0.0, 1.6, 0.0) };
/// Behind the curtain.
pub const BEHIND: View = View { eye: Vec3::new(-4.8, 2.2, -4.6), target: Vec3::new(0.0, 1.5, -0.6) };
