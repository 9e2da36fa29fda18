//! Tells that a body was built.

use bevy::prelude::*;

use crate::entity_events::EntityMessage;

/// Written in the step in which a body is built from its description, or built anew after a change, and triggered on it.
#[derive(EntityEvent, Message, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct BodyBuilt {
    /// The body.
    #[event_target]
    pub body: Entity,
}

impl EntityMessage for BodyBuilt {}
