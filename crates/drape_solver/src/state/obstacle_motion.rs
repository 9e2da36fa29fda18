//! What a step did to obstacles: the momentum that it gave them, and where it moved them.

use glam::Vec3;

use crate::geometry::pose::Placement;
use crate::state::rigid_body::RigidBody;

/// What the bodies and balls of an island did to an obstacle in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// The obstacle, by its index in the environment.
    pub obstacle: usize,
    /// Change of its momentum in newton seconds.
    pub impulse: Vec3,
    /// Change of its angular momentum in newton metre seconds, in world axes, about the place of its origin at the end of
    /// the step: where the impulse is to be given to it.
    pub angular_impulse: Vec3,
}

/// Where a step has brought an obstacle with a [`RigidBody`] that something was near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedObstacle {
    /// The obstacle, by its index in the environment.
    pub obstacle: usize,
    /// Its place at the end of the step.
    pub placement: Placement,
    /// Its motion there.
    pub body: RigidBody,
}
