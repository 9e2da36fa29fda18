//! Results of a step for obstacles: the momentum that they received, and the placements that they reached.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::Vec3;

use crate::geometry::pose::Placement;
use crate::state::rigid_body::RigidBody;

/// Momentum that the bodies and balls of an island gave to an obstacle in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// The obstacle, by its index in the environment.
    pub obstacle: usize,
    /// Change of its momentum in newton seconds.
    pub impulse: Vec3,
    /// Change of its angular momentum in newton metre seconds, in world axes, about its origin at the end of the step.
    /// The impulse acts at that point.
    pub angular_impulse: Vec3,
}

/// Placement and motion of an obstacle with a [`RigidBody`] after a step in which something was near it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedObstacle {
    /// The obstacle, by its index in the environment.
    pub obstacle: usize,
    /// Its place at the end of the step.
    pub placement: Placement,
    /// Its motion there.
    pub body: RigidBody,
}
