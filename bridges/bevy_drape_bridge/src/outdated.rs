//! The colliders and bodies that changed since the last step, so that those which stay as they are cost nothing.

use bevy::prelude::*;
use bevy_drape::change_detection::collect_changed;
use bevy_drape::schedule::DrapeSchedule;

use crate::systems::BridgeSystems;

/// Colliders and bodies to look at anew in the next step; some may be listed twice, or be gone by then.
#[derive(Resource, Default, Debug)]
pub struct Outdated {
    /// Entities with a collider, or that had one.
    pub colliders: Vec<Entity>,
    /// Entities with a body, or that had one.
    pub bodies: Vec<Entity>,
}

impl Outdated {
    /// The listed colliders, each once. None is listed any more.
    pub fn take_colliders(&mut self) -> Vec<Entity> {
        once(&mut self.colliders)
    }

    /// The listed bodies, each once. None is listed any more.
    pub fn take_bodies(&mut self) -> Vec<Entity> {
        once(&mut self.bodies)
    }
}

fn once(listed: &mut Vec<Entity>) -> Vec<Entity> {
    listed.sort_unstable();
    listed.dedup();
    core::mem::take(listed)
}

/// Lists the colliders in which a component is changed, added or removed.
pub fn watch_colliders<C: Component>(app: &mut App) {
    watch_component::<C>(app);
    let note = |changed: Query<(Entity, Ref<C>)>, mut outdated: ResMut<Outdated>| {
        collect_changed(&changed, &mut outdated.colliders);
    };
    app.add_systems(DrapeSchedule, note.in_set(BridgeSystems::NoteChanges));
}

/// Lists the bodies in which a component is changed.
pub fn watch_bodies<C: Component>(app: &mut App) {
    let note = |changed: Query<(Entity, Ref<C>)>, mut outdated: ResMut<Outdated>| {
        collect_changed(&changed, &mut outdated.bodies);
    };
    app.add_systems(DrapeSchedule, note.in_set(BridgeSystems::NoteChanges));
}

/// Lists entities to which a component is added or from which it is removed, as collider and as body.
pub fn watch_component<C: Component>(app: &mut App) {
    app.add_observer(|inserted: On<Insert<C>>, mut outdated: ResMut<Outdated>| {
        outdated.colliders.push(inserted.entity);
        outdated.bodies.push(inserted.entity);
    });
    app.add_observer(|removed: On<Remove<C>>, mut outdated: ResMut<Outdated>| {
        outdated.colliders.push(removed.entity);
        outdated.bodies.push(removed.entity);
    });
}
