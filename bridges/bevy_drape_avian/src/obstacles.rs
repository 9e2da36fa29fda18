//! Colliders and dynamic bodies as obstacles.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape_bridge::{
    BodyObstacle, BodyParts, BodyReach, HasObstacle, InertialFrame, NoObstacle, Outdated, Part,
    obstacle_shape, update_body, update_collider,
};

use crate::motion::{place_in_body, placement};
use crate::surface::Surfaces;

/// A collider, and what decides about its obstacle.
type ColliderQuery<'w, 's> = Query<
    'w,
    's,
    (
        Option<&'static Collider>,
        Option<&'static CollisionLayers>,
        Option<&'static ColliderOf>,
        Has<Sensor>,
        Has<ColliderDisabled>,
        Has<NoObstacle>,
        HasObstacle,
    ),
>;

/// A body, and what decides about its obstacle.
type BodyQuery<'w, 's> = Query<
    'w,
    's,
    (
        &'static RigidBody,
        Option<&'static RigidBodyColliders>,
        &'static ComputedMass,
        &'static ComputedAngularInertia,
        &'static ComputedCenterOfMass,
        (&'static Position, &'static Rotation),
        Option<(&'static BodyObstacle, &'static BodyReach)>,
        Has<RigidBodyDisabled>,
    ),
>;

/// Colliders that are part of a body's obstacle.
type PartQuery<'w, 's> = Query<
    'w,
    's,
    (Entity, &'static Collider, &'static ColliderTransform, Option<&'static CollisionLayers>),
    (Without<Sensor>, Without<ColliderDisabled>, Without<NoObstacle>, Without<Obstacle>),
>;

/// Brings the obstacles of all colliders that changed up to date, and lists their bodies. A collider of a dynamic body is
/// part of the obstacle of that; a sensor is one of its own.
pub(crate) fn update_colliders(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    colliders: ColliderQuery,
    bodies: Query<&RigidBody>,
    surfaces: Surfaces,
) {
    for entity in outdated.take_colliders() {
        let Ok((collider, layers, of, is_sensor, is_disabled, is_left_out, has)) = colliders.get(entity)
        else {
            continue;
        };
        let body = of.map_or(entity, |of| of.body);
        outdated.bodies.push(body);
        let is_part = !is_sensor && bodies.get(body).is_ok_and(RigidBody::is_dynamic);
        let collider = collider.filter(|_| !is_disabled && !is_left_out && !is_part);
        let obstacle = collider.map(|collider| {
            // Cloth scales the shape by the transform, as Avian does.
            let shape = obstacle_shape(collider.shape());
            let obstacle = Obstacle { shape, is_sensor, ..surfaces.of(entity).obstacle() };
            (obstacle, drape_layers(layers))
        });
        update_collider(&mut commands, entity, has, obstacle);
    }
}

/// Brings the obstacles of all dynamic bodies that changed up to date. Runs after those of colliders.
pub(crate) fn update_bodies(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    bodies: BodyQuery,
    parts: PartQuery,
    surfaces: Surfaces,
) {
    for entity in outdated.take_bodies() {
        let Ok((kind, colliders, mass, inertia, centre, place, known, is_disabled)) = bodies.get(entity)
        else {
            continue;
        };
        let is_dynamic = kind.is_dynamic() && !is_disabled && mass.is_finite();
        let colliders = colliders.into_iter().flatten().filter(|_| is_dynamic);
        let found: Vec<_> = colliders.filter_map(|collider| parts.get(collider).ok()).collect();
        let body = found.first().map(|&(first, .., layers)| {
            let (moments, axes) = inertia.principal_angular_inertia_with_local_frame();
            BodyParts {
                mass: mass.value(),
                frame: InertialFrame { centre: centre.0, axes, moments },
                place: placement(place.0, place.1),
                parts: found
                    .iter()
                    .map(|&(entity, collider, place, _)| part(entity, collider, place))
                    .collect(),
                surface: surfaces.of(first).obstacle(),
                layers: drape_layers(layers),
            }
        });
        update_body(&mut commands, entity, known, body);
    }
}

fn part(entity: Entity, collider: &Collider, place: &ColliderTransform) -> Part {
    Part { entity, shape: collider.shape_scaled().clone(), place: place_in_body(place) }
}

fn drape_layers(layers: Option<&CollisionLayers>) -> DrapeLayers {
    let layers = layers.copied().unwrap_or_default();
    DrapeLayers::new(layers.memberships.0, layers.filters.0)
}
