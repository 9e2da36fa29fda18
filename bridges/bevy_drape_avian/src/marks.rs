//! Marks on colliders, and the ties of bodies to their obstacles.

use avian3d::prelude::{Position, Rotation};
use bevy::prelude::*;
use bevy_drape::environment::PlannedPlacement;

/// Leaves a collider out: cloth passes through it.
///
/// ```
/// # use avian3d::prelude::*;
/// # use bevy::prelude::*;
/// # use bevy_drape_avian::NoObstacle;
/// # fn setup(mut commands: Commands) {
/// // The player is stopped, the curtain is not.
/// commands.spawn((RigidBody::Static, Collider::cuboid(2.0, 3.0, 0.1), NoObstacle));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct NoObstacle;

/// Marks the [`Obstacle`](bevy_drape::prelude::Obstacle) that was made of the entity's collider, on a static or kinematic
/// body, and that follows its changes. A collider with an obstacle of your own keeps that.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct ColliderObstacle;

/// On the obstacle that stands in for a dynamic body: the body. Messages of contacts and hits name this obstacle, which
/// has the colliders of the body as one shape.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[relationship(relationship_target = BodyObstacle)]
#[require(LeftAt, Load, PlannedPlacement)]
#[reflect(Component, Debug, Clone, PartialEq)]
pub struct ObstacleOf(pub Entity);

/// On a dynamic body: the obstacle that stands in for it.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[relationship_target(relationship = ObstacleOf, linked_spawn)]
#[reflect(Component, Debug, Clone, PartialEq)]
pub struct BodyObstacle(Entity);

impl BodyObstacle {
    /// The obstacle.
    pub fn entity(&self) -> Entity {
        self.0
    }
}

/// The place of a body after the last step.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LeftAt {
    position: Vec3,
    rotation: Quat,
}

impl LeftAt {
    pub fn new(position: &Position, rotation: &Rotation) -> Self {
        Self { position: position.0, rotation: rotation.0 }
    }
}

/// The support that a body has of cloth.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load {
    /// Mean acceleration by which cloth has lately held or pushed the body, in m/s^2.
    pub acceleration: Vec3,
    /// Seconds for which the body has been slow enough for sleep.
    pub still_for: f32,
}
