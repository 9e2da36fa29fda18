//! Watches what makes a collider an obstacle come, go and change.

use bevy::prelude::*;
use bevy_drape::change_detection::collect_changed;
use bevy_drape::environment::DynamicObstacle;
use bevy_drape_bridge::{
    BodyReach, InertialFrame, NoObstacle, ObstacleOf, Outdated, Parts, reach_of, watch_bodies,
    watch_colliders, watch_component,
};
use bevy_rapier3d::geometry::{
    Collider, ColliderDisabled, ColliderScale, CollisionGroups, Friction, RapierColliderHandle, Restitution,
    Sensor,
};
use bevy_rapier3d::prelude::{RapierRigidBodyHandle, RigidBody, RigidBodyDisabled};

use crate::obstacles::{PartQuery, frame, parts_of};
use crate::world::{RapierWorld, place_in_body};

pub(crate) fn watch(app: &mut App) {
    watch_colliders::<Collider>(app);
    watch_colliders::<ColliderScale>(app);
    watch_colliders::<CollisionGroups>(app);
    watch_colliders::<Friction>(app);
    watch_colliders::<Restitution>(app);
    watch_component::<ColliderDisabled>(app);
    watch_component::<NoObstacle>(app);
    watch_component::<RapierColliderHandle>(app);
    watch_component::<RapierRigidBodyHandle>(app);
    watch_component::<RigidBody>(app);
    watch_component::<RigidBodyDisabled>(app);
    watch_component::<Sensor>(app);
    watch_bodies::<RigidBody>(app);
}

/// Lists the bodies of which mass or colliders changed, and all colliders of bodies that are listed.
pub(crate) fn note_bodies(
    mut outdated: ResMut<Outdated>,
    obstacles: Query<(&ObstacleOf, &InertialFrame, &DynamicObstacle, &Parts)>,
    places: Query<(Entity, Ref<Transform>), (With<RapierColliderHandle>, Without<RigidBody>)>,
    mut reaches: Query<&mut BodyReach>,
    world: RapierWorld,
    may_be_part: PartQuery,
    mut moved: Local<Vec<Entity>>,
) {
    let Outdated { colliders: listed, bodies: listed_bodies } = &mut *outdated;
    // Colliders that move in their bodies, also where cloth is far and the obstacle disabled. Rapier learns of it in a later step.
    moved.clear();
    collect_changed(&places, &mut moved);
    for &entity in &*moved {
        let Some((body, collider)) = world.body_of(entity).zip(world.collider(entity)) else { continue };
        if let (Ok((_, place)), Ok(mut reach)) = (places.get(entity), reaches.get_mut(body)) {
            reach.grow(place.translation.length() + reach_of(collider.shared_shape()));
        }
    }
    for &body in &*listed_bodies {
        listed.extend(world.colliders_of(body).map(|(collider, _)| collider));
    }
    for (of, known, dynamic, parts) in &obstacles {
        let now = parts_of(of.0, &world, &may_be_part);
        let now = now.map(|(entity, collider)| (entity, place_in_body(collider)));
        let is_known =
            world.body(of.0).is_some_and(|body| frame(body) == *known && body.mass() == dynamic.mass);
        if !is_known || !now.eq(parts.0.iter().copied()) {
            listed_bodies.push(of.0);
            listed.extend(parts.0.iter().map(|(part, _)| part));
        }
    }
}
