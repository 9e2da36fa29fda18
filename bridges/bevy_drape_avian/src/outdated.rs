//! The colliders and bodies that changed since the last step, so that those which stay as they are cost nothing.

use avian3d::prelude::*;
use bevy::prelude::*;

use crate::marks::{BodyObstacle, NoObstacle};

/// Colliders and bodies to look at anew in the next step; some may be listed twice, or be gone by then.
#[derive(Resource, Default, Debug)]
pub(crate) struct Outdated {
    pub colliders: Vec<Entity>,
    pub bodies: Vec<Entity>,
}

/// The colliders in the obstacle of a body, each with its place in the body.
#[derive(Component, Debug, Default)]
pub(crate) struct Parts(pub Vec<(Entity, ColliderTransform)>);

/// Watches what makes a collider an obstacle come and go.
pub(crate) fn watch(app: &mut App) {
    app.init_resource::<Outdated>();
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

fn watch_component<C: Component>(app: &mut App) {
    app.add_observer(|inserted: On<Insert<C>>, mut outdated: ResMut<Outdated>| {
        outdated.colliders.push(inserted.entity);
        outdated.bodies.push(inserted.entity);
    });
    app.add_observer(|removed: On<Remove<C>>, mut outdated: ResMut<Outdated>| {
        outdated.colliders.push(removed.entity);
        outdated.bodies.push(removed.entity);
    });
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
        if parts.is_ok_and(|parts| parts.0.iter().any(|(part, known)| *part == entity && known != place)) {
            outdated.bodies.push(of.body);
        }
    }
}
