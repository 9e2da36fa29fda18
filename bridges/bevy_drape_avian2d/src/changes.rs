//! Watches what makes a collider an obstacle come, go and change.

use avian2d::prelude::*;
use bevy::prelude::*;
use bevy_drape_bridge::{NoObstacle, Outdated, watch_colliders, watch_component};

pub(crate) fn watch(app: &mut App) {
    watch_colliders::<Collider>(app);
    watch_colliders::<Friction>(app);
    watch_colliders::<Restitution>(app);
    watch_component::<ColliderDisabled>(app);
    watch_component::<ColliderOf>(app);
    // Nothing changes these in place.
    watch_component::<CollisionLayers>(app);
    watch_component::<NoObstacle>(app);
    watch_component::<RigidBodyDisabled>(app);
    watch_component::<Sensor>(app);
}

/// Lists all colliders of bodies that are listed, whose material they may have.
pub(crate) fn note_colliders(
    mut outdated: ResMut<Outdated>,
    bodies: Query<&RigidBodyColliders>,
    all: Query<Entity, With<Collider>>,
    defaults: (Res<DefaultFriction>, Res<DefaultRestitution>),
) {
    // Bodies have no obstacles of their own here.
    outdated.bodies.clear();
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
