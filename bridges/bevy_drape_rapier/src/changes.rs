//! Watches what makes a collider an obstacle come, go and change.

use bevy::prelude::*;
use bevy_drape::environment::DynamicObstacle;
use bevy_drape_bridge::{
    InertialFrame, NoObstacle, ObstacleOf, Outdated, Parts, watch_bodies, watch_colliders, watch_component,
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
    world: RapierWorld,
    may_be_part: PartQuery,
) {
    let Outdated { colliders: listed, bodies: listed_bodies } = &mut *outdated;
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
