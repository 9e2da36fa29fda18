//! Watches what makes a collider an obstacle come, go and change.

use avian3d::prelude::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::change_detection::collect_changed;
use bevy_drape_bridge::{
    BodyObstacle, NoObstacle, Outdated, Parts, watch_bodies, watch_colliders, watch_component,
};

use crate::motion::place_in_body;

pub(crate) fn watch(app: &mut App) {
    watch_colliders::<Collider>(app);
    watch_colliders::<Friction>(app);
    watch_colliders::<Restitution>(app);
    watch_component::<ColliderDisabled>(app);
    watch_component::<ColliderOf>(app);
    // Nothing changes these in place.
    watch_component::<CollisionLayers>(app);
    watch_component::<NoObstacle>(app);
    watch_component::<RigidBody>(app);
    watch_component::<RigidBodyDisabled>(app);
    watch_component::<Sensor>(app);
    watch_bodies::<ComputedAngularInertia>(app);
    watch_bodies::<ComputedCenterOfMass>(app);
    watch_bodies::<ComputedMass>(app);
    watch_bodies::<RigidBodyColliders>(app);
}

/// Lists all colliders of bodies that are listed, whose material they may have.
pub(crate) fn note_colliders(
    mut outdated: ResMut<Outdated>,
    bodies: Query<&RigidBodyColliders>,
    all: Query<Entity, With<Collider>>,
    defaults: (Res<DefaultFriction>, Res<DefaultRestitution>),
) {
    let outdated = &mut outdated.colliders;
    for listed in 0..outdated.len() {
        if let Ok(colliders) = bodies.get(outdated[listed]) {
            outdated.extend(colliders.iter());
        }
    }
    if defaults.0.is_changed() || defaults.1.is_changed() {
        outdated.extend(&all);
    }
}

/// Lists the bodies in which a collider has moved.
pub(crate) fn note_bodies(
    mut outdated: ResMut<Outdated>,
    places: Query<(Entity, Ref<ColliderTransform>)>,
    colliders: Query<(&ColliderTransform, &ColliderOf)>,
    obstacles: Query<&BodyObstacle>,
    parts: Query<&Parts, Allow<Disabled>>,
    mut moved: Local<Vec<Entity>>,
) {
    moved.clear();
    collect_changed(&places, &mut moved);
    // Avian writes the places of all colliders below a body that moves.
    for &entity in &*moved {
        let Ok((place, of)) = colliders.get(entity) else { continue };
        let parts = obstacles.get(of.body).and_then(|obstacle| parts.get(obstacle.entity()));
        let is_moved = |&(part, known)| part == entity && known != place_in_body(place);
        if parts.is_ok_and(|parts| parts.0.iter().any(is_moved)) {
            outdated.bodies.push(of.body);
        }
    }
}
