//! The colliders that changed since the last step, so that those which stay as they are cost nothing.

use avian3d::prelude::*;
use bevy::prelude::*;

use crate::marks::NoObstacle;

/// Colliders to look at anew in the next step; some may be listed twice, or be gone by then.
#[derive(Resource, Default, Debug)]
pub(crate) struct Outdated(pub Vec<Entity>);

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
    watch_component::<Sensor>(app);
}

fn watch_component<C: Component>(app: &mut App) {
    app.add_observer(|inserted: On<Insert<C>>, mut outdated: ResMut<Outdated>| {
        outdated.0.push(inserted.entity);
    });
    app.add_observer(|removed: On<Remove<C>>, mut outdated: ResMut<Outdated>| {
        outdated.0.push(removed.entity);
    });
}

/// Lists the colliders that were changed in place, and all colliders of bodies that are listed, whose material they may have.
pub(crate) fn note_changes(
    mut outdated: ResMut<Outdated>,
    changed: Query<
        Entity,
        Or<(Changed<Collider>, Changed<CollisionLayers>, Changed<Friction>, Changed<Restitution>)>,
    >,
    bodies: Query<&RigidBodyColliders>,
    all: Query<Entity, With<Collider>>,
    defaults: (Res<DefaultFriction>, Res<DefaultRestitution>),
) {
    let outdated = &mut outdated.0;
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
