//! Makes obstacles of colliders, and takes them away again.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::drape_solver::Shape;
use bevy_drape::environment::ObstacleShape;
use bevy_drape::prelude::*;

use crate::marks::{ColliderObstacle, NoObstacle};
use crate::outdated::Outdated;
use crate::surface::{Surface, Surfaces};

/// A collider, and what decides about its obstacle.
type ColliderQuery<'w, 's> = Query<
    'w,
    's,
    (
        Option<&'static Collider>,
        Option<&'static CollisionLayers>,
        Has<Sensor>,
        Has<ColliderDisabled>,
        Has<NoObstacle>,
        Has<Obstacle>,
        Has<ColliderObstacle>,
    ),
>;

/// Brings the obstacles of all colliders that changed up to date.
pub(crate) fn update_obstacles(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    colliders: ColliderQuery,
    surfaces: Surfaces,
) {
    outdated.0.sort_unstable();
    outdated.0.dedup();
    for entity in outdated.0.drain(..) {
        let Ok((collider, layers, is_sensor, is_disabled, is_left_out, has_obstacle, is_ours)) =
            colliders.get(entity)
        else {
            continue;
        };
        let collider = collider.filter(|_| !is_disabled && !is_left_out);
        match collider {
            Some(_) if has_obstacle && !is_ours => {}
            Some(collider) => {
                let layers = layers.copied().unwrap_or_default();
                commands.entity(entity).try_insert((
                    obstacle(collider, surfaces.of(entity), is_sensor),
                    DrapeLayers::new(layers.memberships.0, layers.filters.0),
                    ColliderObstacle,
                ));
            }
            None if is_ours => {
                commands.entity(entity).try_remove::<(Obstacle, DrapeLayers, ColliderObstacle)>();
            }
            None => {}
        }
    }
}

/// The obstacle of a collider, scaled by the transform as Avian's is.
fn obstacle(collider: &Collider, surface: Surface, is_sensor: bool) -> Obstacle {
    let shape = collider.shape();
    // What cannot be an obstacle is refused by the plugin, which names the entity.
    let shape = Shape::from_parry(shape.clone()).map_or_else(|_| shape.clone().into(), ObstacleShape::from);
    Obstacle {
        friction: surface.friction.dynamic_coefficient,
        static_friction: surface.friction.static_coefficient,
        restitution: surface.restitution.coefficient,
        is_sensor,
        ..Obstacle::new(shape)
    }
}
