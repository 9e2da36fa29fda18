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
        Option<&'static ColliderOf>,
    ),
>;

/// Brings the obstacles of all colliders that changed up to date, and lists their bodies. A collider of a dynamic body is
/// part of the obstacle of that; a sensor is one of its own.
pub(crate) fn update_obstacles(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    colliders: ColliderQuery,
    bodies: Query<&RigidBody>,
    surfaces: Surfaces,
) {
    let Outdated { colliders: changed, bodies: changed_bodies } = &mut *outdated;
    changed.sort_unstable();
    changed.dedup();
    for entity in changed.drain(..) {
        let Ok((collider, layers, is_sensor, is_disabled, is_left_out, has_obstacle, is_ours, of)) =
            colliders.get(entity)
        else {
            continue;
        };
        let body = of.map_or(entity, |of| of.body);
        changed_bodies.push(body);
        let is_part = !is_sensor && bodies.get(body).is_ok_and(RigidBody::is_dynamic);
        let collider = collider.filter(|_| !is_disabled && !is_left_out && !is_part);
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
    Obstacle { is_sensor, ..surface.obstacle(shape) }
}
