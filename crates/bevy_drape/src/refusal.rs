//! Invalid input: logged once and left out of the simulation.

use std::collections::BTreeMap;

use bevy::prelude::*;

/// Everything that is left out of the simulation, and why. Each fault is logged once as an error, not sixty times a
/// second.
#[derive(Resource, Reflect, Clone, Debug, Default)]
#[reflect(opaque)]
#[reflect(Resource, Default, Debug, Clone)]
pub struct Refusals(BTreeMap<(Option<Entity>, &'static str), String>);

impl Refusals {
    /// The faults as logged. A fault is forgotten when its component is rebuilt or removed.
    pub fn messages(&self) -> impl ExactSizeIterator<Item = &str> {
        self.0.values().map(String::as_str)
    }

    /// The faults of `entity`.
    pub fn of(&self, entity: Entity) -> impl Iterator<Item = &str> {
        let faults = self.0.iter().filter(move |((about, _), _)| *about == Some(entity));
        faults.map(|(_, message)| message.as_str())
    }

    /// Logs that a component of `entity` cannot be used, unless that was logged before.
    pub(crate) fn entity(
        &mut self,
        entity: Entity,
        component: &'static str,
        reason: impl core::fmt::Display,
    ) {
        let message = format!("{component} of entity {entity} is left out of the simulation: {reason}");
        self.tell((Some(entity), component), message);
    }

    /// Logs that a resource cannot be used, unless that was logged before.
    pub(crate) fn resource(&mut self, resource: &'static str, reason: impl core::fmt::Display) {
        self.tell((None, resource), format!("resource {resource} cannot be used: {reason}"));
    }

    /// Forgets the faults of `entity`, after it was despawned or mended.
    pub(crate) fn forget(&mut self, entity: Entity) {
        self.0.retain(|(about, _), _| *about != Some(entity));
    }

    /// Forgets the fault of a component of `entity`, after it was changed.
    pub(crate) fn forget_component(&mut self, entity: Entity, component: &'static str) {
        self.0.remove(&(Some(entity), component));
    }

    /// Forgets the fault of a resource, after it was mended.
    pub(crate) fn forget_resource(&mut self, resource: &'static str) {
        self.0.remove(&(None, resource));
    }

    fn tell(&mut self, about: (Option<Entity>, &'static str), message: String) {
        if self.0.get(&about) != Some(&message) {
            error!("{message}");
            self.0.insert(about, message);
        }
    }
}

/// Forgets the faults of an entity that loses its `C`.
pub(crate) fn forget_removed<C: Component>(removed: On<Remove<C>>, mut refusals: ResMut<Refusals>) {
    refusals.forget(removed.entity);
}
