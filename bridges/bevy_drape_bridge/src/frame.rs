//! The frame of a body in which its inertia has no products.

use bevy::prelude::*;
use bevy_drape::drape_solver::Placement;

/// The principal axes of a body about its centre of mass, in its own frame, and the moments of inertia about them.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct InertialFrame {
    /// Centre of mass, in metres.
    pub centre: Vec3,
    /// Rotation from the axes of the body to the principal axes.
    pub axes: Quat,
    /// Principal moments of inertia in kg m^2.
    pub moments: Vec3,
}

impl InertialFrame {
    /// The place of the frame in the world, of a body that is here.
    pub fn of_body(&self, body: Placement) -> Placement {
        Placement {
            translation: body.translation + body.rotation * self.centre,
            rotation: body.rotation * self.axes,
        }
    }

    /// The body's place in the world, if the frame is here.
    pub fn body_at(&self, frame: Placement) -> Placement {
        let rotation = (frame.rotation * self.axes.conjugate()).normalize();
        Placement { translation: frame.translation - rotation * self.centre, rotation }
    }

    /// The place in this frame of a place in the body.
    pub fn placed(&self, place: Placement) -> Placement {
        let back = self.axes.conjugate();
        Placement { translation: back * (place.translation - self.centre), rotation: back * place.rotation }
    }
}
