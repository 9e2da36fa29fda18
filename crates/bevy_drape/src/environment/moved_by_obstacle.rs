//! Entities that move with a dynamic obstacle.

use bevy::prelude::*;

/// On an entity that moves with a [`DynamicObstacle`](crate::environment::dynamic_obstacle::DynamicObstacle) of its own: a body of
/// another physics engine, whose obstacle stands in for it. Cloth and ropes that are
/// [attached](crate::attach::attachment::Attachment) to the entity pull at the obstacle.
#[derive(Component, FromTemplate, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Clone, PartialEq)]
pub struct MovedByObstacle {
    /// The obstacle.
    #[entities]
    pub obstacle: Entity,
    /// Place of the entity's origin in the obstacle's frame, in metres.
    pub translation: Vec3,
    /// Rotation of the entity's axes in that frame.
    pub rotation: Quat,
}
