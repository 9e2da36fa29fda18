//! Colliders as obstacles.

use std::collections::BTreeMap;

use avian2d::prelude::*;
use bevy::prelude::*;
use bevy_drape::drape_solver::BuildError;
use bevy_drape::prelude::*;
use bevy_drape_bridge::{HasObstacle, NoObstacle, Outdated, update_collider};

use crate::prism::prism;
use crate::surface::Surfaces;

/// A collider, and what decides about its obstacle.
type ColliderQuery<'w, 's> = Query<
    'w,
    's,
    (
        Option<&'static Collider>,
        Option<&'static CollisionLayers>,
        Option<&'static ColliderOf>,
        Option<&'static Name>,
        Has<Sensor>,
        Has<ColliderDisabled>,
        Has<NoObstacle>,
        HasObstacle,
    ),
>;

/// Brings the obstacles of all colliders that changed up to date. Logs once for each that cannot be one.
pub(crate) fn update_colliders(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    mut refused: Local<BTreeMap<Entity, BuildError>>,
    colliders: ColliderQuery,
    disabled: Query<(), With<RigidBodyDisabled>>,
    surfaces: Surfaces,
) {
    for entity in outdated.take_colliders() {
        let Ok((collider, layers, of, name, is_sensor, is_disabled, is_left_out, has)) =
            colliders.get(entity)
        else {
            refused.remove(&entity);
            continue;
        };
        let is_disabled = is_disabled || disabled.contains(of.map_or(entity, |of| of.body));
        let solid = collider.filter(|_| !is_disabled && !is_left_out).map(prism).transpose();
        let error = solid.as_ref().err();
        if let Some(error) = error
            && refused.get(&entity) != Some(error)
        {
            let name = name.map_or_else(String::new, |name| format!(" “{name}”"));
            error!("Collider of entity {entity}{name} is no obstacle of cloth: {error}");
        }
        match error {
            Some(error) => _ = refused.insert(entity, error.clone()),
            None => _ = refused.remove(&entity),
        }
        let obstacle = solid.ok().flatten().map(|shape| {
            let obstacle = Obstacle { shape: shape.into(), is_sensor, ..surfaces.of(entity).obstacle() };
            let layers = layers.copied().unwrap_or_default();
            (obstacle, DrapeLayers::new(layers.memberships.0, layers.filters.0))
        });
        update_collider(&mut commands, entity, has, obstacle);
    }
}
