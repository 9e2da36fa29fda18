//! Makes obstacles of the colliders of static and kinematic bodies, and takes them away again.

use bevy::prelude::*;
use bevy_drape::drape_solver::Shape;
use bevy_drape::drape_solver::parry3d::shape::SharedShape;
use bevy_drape::environment::ObstacleShape;
use bevy_drape::prelude::*;

use crate::marks::ColliderObstacle;

/// The shape of a collider, which is shared and not copied. The plugin refuses one that cannot be an obstacle, and names its
/// entity.
pub fn obstacle_shape(shape: &SharedShape) -> ObstacleShape {
    Shape::from_parry(shape.clone()).map_or_else(|_| shape.clone().into(), ObstacleShape::from)
}

/// True each if the entity of a collider has an obstacle, and if it was made of the collider.
pub type HasObstacle = (Has<Obstacle>, Has<ColliderObstacle>);

/// Gives the entity of a collider this obstacle, or takes the obstacle away that it was given before. An obstacle of the user's
/// own stays.
pub fn update_collider(
    commands: &mut Commands,
    entity: Entity,
    (has_obstacle, is_ours): (bool, bool),
    obstacle: Option<(Obstacle, DrapeLayers)>,
) {
    let mut commands = commands.entity(entity);
    match obstacle {
        Some(_) if has_obstacle && !is_ours => {}
        Some(obstacle) => _ = commands.try_insert((obstacle, ColliderObstacle)),
        None if is_ours => _ = commands.try_remove::<(Obstacle, DrapeLayers, ColliderObstacle)>(),
        None => {}
    }
}
