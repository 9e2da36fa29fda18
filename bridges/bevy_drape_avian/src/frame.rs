//! The frame of a body in which its inertia has no products.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::drape_solver::Placement;

/// The principal axes of a body about its centre of mass, in its own frame, and the moments of inertia about them.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(crate) struct InertialFrame {
    centre: Vec3,
    axes: Quat,
    /// In kg m^2.
    pub moments: Vec3,
}

impl InertialFrame {
    pub fn new(centre: &ComputedCenterOfMass, inertia: &ComputedAngularInertia) -> Self {
        let (moments, axes) = inertia.principal_angular_inertia_with_local_frame();
        Self { centre: centre.0, axes, moments }
    }

    /// The place of the frame in the world, of a body that is here.
    pub fn of_body(&self, position: &Position, rotation: &Rotation) -> Placement {
        Placement { translation: position.0 + rotation.0 * self.centre, rotation: rotation.0 * self.axes }
    }

    /// The body's place in the world, if the frame is here.
    pub fn body_at(&self, translation: Vec3, rotation: Quat) -> (Position, Rotation) {
        let rotation = (rotation * self.axes.conjugate()).normalize();
        (Position(translation - rotation * self.centre), Rotation(rotation))
    }

    /// The place in this frame of a place in the body.
    pub fn placed(&self, place: Placement) -> Placement {
        let back = self.axes.conjugate();
        Placement { translation: back * (place.translation - self.centre), rotation: back * place.rotation }
    }
}
