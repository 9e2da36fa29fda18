//! Marks on colliders, and the ties of bodies to their obstacles.

use bevy::prelude::*;
use bevy_drape::environment::PlannedPlacement;

/// Leaves a collider out: cloth passes through it.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape_bridge::NoObstacle;
/// # #[derive(Component)] struct Collider;
/// # fn setup(mut commands: Commands) {
/// // The player is stopped, the curtain is not.
/// commands.spawn((Collider, NoObstacle));
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
#[require(PlannedPlacement)]
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
