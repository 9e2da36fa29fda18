//! Bad input: told once, clearly, and left out.

use std::collections::BTreeSet;

use bevy::prelude::*;

/// What has been refused already, so that each fault is logged once and not sixty times a second.
#[derive(Resource, Default)]
pub(crate) struct Refusals(BTreeSet<(Option<Entity>, String)>);

impl Refusals {
    /// Logs that `entity`'s `component` cannot be used, unless it was said before.
    pub fn entity(&mut self, entity: Entity, component: &str, reason: impl core::fmt::Display) {
        let message = format!("{component} of entity {entity} is left out of the simulation: {reason}");
        if self.0.insert((Some(entity), message.clone())) {
            error!("{message}");
        }
    }

    /// Logs that a resource cannot be used, unless it was said before.
    pub fn resource(&mut self, resource: &str, reason: impl core::fmt::Display) {
        let message = format!("resource {resource} cannot be used: {reason}");
        if self.0.insert((None, message.clone())) {
            error!("{message}");
        }
    }

    /// Forgets what was said about `entity`, when it is gone or was mended.
    pub fn forget(&mut self, entity: Entity) {
        self.0.retain(|(about, _)| *about != Some(entity));
    }
}
