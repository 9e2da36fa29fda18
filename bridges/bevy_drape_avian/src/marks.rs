//! Marks on colliders.

use bevy::prelude::*;

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

/// Marks the [`Obstacle`](bevy_drape::prelude::Obstacle) that was made of the entity's collider, and that follows its changes. A collider with an obstacle
/// of your own keeps that.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct ColliderObstacle;
