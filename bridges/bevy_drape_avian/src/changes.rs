//! Watches what makes a collider an obstacle come, go and change.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape_bridge::{BodyObstacle, NoObstacle, Outdated, Parts, watch_component};

use crate::motion::place_in_body;

pub(crate) fn watch(app: &mut App) {
    watch_component::<Collider>(app);
    watch_component::<ColliderDisabled>(app);
    watch_component::<ColliderOf>(app);
    watch_component::<CollisionLayers>(app);
    watch_component::<Friction>(app);
    watch_component::<NoObstacle>(app);
    watch_component::<Restitution>(app);
    watch_component::<RigidBody>(app);
    watch_component::<RigidBodyDisabled>(app);
    watch_component::<Sensor>(app);
}

/// Lists the colliders that were changed in place, and all colliders of bodies that are listed, whose material they may have.
pub(crate) fn note_colliders(
    mut outdated: ResMut<Outdated>,
    changed: Query<
        Entity,
        Or<(Changed<Collider>, Changed<CollisionLayers>, Changed<Friction>, Changed<Restitution>)>,
    >,
    bodies: Query<&RigidBodyColliders>,
    all: Query<Entity, With<Collider>>,
    defaults: (Res<DefaultFriction>, Res<DefaultRestitution>),
) {
    let outdated = &mut outdated.colliders;
    outdated.extend(&changed);
    for listed in 0..outdated.len() {
        if let Ok(colliders) = bodies.get(outdated[listed]) {
            outdated.extend(colliders.iter());
        }
    }
    if defaults.0.is_changed() || defaults.1.is_changed() {
        outdated.extend(&all);
    }
}

/// Lists the bodies whose mass changed, and those that gained, lost or moved a collider.
pub(crate) fn note_bodies(
    mut outdated: ResMut<Outdated>,
    changed: Query<
        Entity,
        Or<(
            Changed<RigidBodyColliders>,
            Changed<ComputedMass>,
            Changed<ComputedAngularInertia>,
            Changed<ComputedCenterOfMass>,
        )>,
    >,
    moved: Query<(Entity, &ColliderTransform, &ColliderOf), Changed<ColliderTransform>>,
    obstacles: Query<&BodyObstacle>,
    parts: Query<&Parts>,
) {
    outdated.bodies.extend(&changed);
    // Avian writes the places of all colliders below a body that moves.
    for (entity, place, of) in &moved {
        let parts = obstacles.get(of.body).and_then(|obstacle| parts.get(obstacle.entity()));
        if parts.is_ok_and(|parts| {
            parts.0.iter().any(|&(part, known)| part == entity && known != place_in_body(place))
        }) {
            outdated.bodies.push(of.body);
        }
    }
}
