//! Messages about contacts: beginnings, ends, hard hits.

use bevy::ecs::event::EntityTrigger;
use bevy::prelude::*;
use drape_solver::Feature;

use crate::entity_events::EntityMessage;

/// The part of a body that touches, by index.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Debug, Clone, PartialEq)]
pub enum ContactFeature {
    /// A particle of a cloth or rope.
    Particle(usize),
    /// A face of a cloth.
    Face(usize),
}

impl From<Feature> for ContactFeature {
    fn from(feature: Feature) -> Self {
        match feature {
            Feature::Particle(index) => Self::Particle(index),
            Feature::Face(index) => Self::Face(index),
        }
    }
}

/// Contact of two entities in one step. All particles of a cloth that touch the same entity are one contact.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContact {
    /// The body or ball that touches something. Between a ball and a cloth, the ball. Observers see the entity that they observe,
    /// be it an obstacle.
    pub body: Entity,
    /// The entity that it touches.
    pub other: Entity,
    /// Simulated time in seconds of the first touch in this step: interpolated for balls, rounded to a substep for
    /// particles and sensors.
    pub time: f64,
    /// Point on the other's surface with the greatest impulse on a cloth, or of the first touch of a ball. In a sensor,
    /// the position of a particle or of the ball's centre.
    pub point: Vec3,
    /// Unit normal at the point, from the other towards the body. In a sensor, from its middle to the point.
    pub normal: Vec3,
    /// Sum of the magnitudes of all normal impulses in this step, in newton seconds; 0 for a sensor.
    pub impulse: f32,
    /// The particle or face at the point. None between balls, and between a ball and an obstacle.
    pub feature: Option<ContactFeature>,
}

impl DrapeContact {
    /// The same as the other entity sees it. The part that touches is the body's, and is left out.
    fn for_the_other(&self) -> Self {
        Self { body: self.other, other: self.body, normal: -self.normal, feature: None, ..*self }
    }
}

/// Events that are a [`DrapeContact`].
macro_rules! contact_events {
    ($($event:ident)*) => { $(
        impl Event for $event {
            type Trigger<'a> = EntityTrigger;
        }

        impl EntityEvent for $event {
            fn event_target(&self) -> Entity {
                self.body
            }
        }

        impl EntityMessage for $event {
            fn for_the_other(&self) -> Option<Self> {
                Some(Self(self.0.for_the_other()))
            }
        }
    )* };
}

contact_events! { DrapeContactStarted DrapeContactHit }

impl EntityMessage for DrapeContactEnded {
    fn for_the_other(&self) -> Option<Self> {
        Some(Self { body: self.other, other: self.body, time: self.time })
    }
}

/// Written in the step in which a contact begins, and triggered on both entities.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Deref)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactStarted(pub DrapeContact);

/// Written in the step in which the impulse of a contact reaches [`hit_impulse`](DrapeContactSettings::hit_impulse), and triggered
/// on both entities; again only after the impulse has fallen below half of that.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Deref)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactHit(pub DrapeContact);

/// Written when two entities have not touched for a tenth of a second, and triggered on both. Resting entities keep touching. An
/// entity may have been despawned by then.
#[derive(EntityEvent, Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactEnded {
    /// The body or ball that touched something; for observers, the entity that they observe.
    #[event_target]
    pub body: Entity,
    /// The entity that it touched.
    pub other: Entity,
    /// Simulated time in seconds of the end of the last step in which they touched.
    pub time: f64,
}

/// Limits for messages about contacts.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeContactSettings {
    /// The most messages, of all three kinds together, in one step; 256 by default. Further starts and ends wait for
    /// the next step; further hits are lost.
    pub max_messages: usize,
    /// Impulse of a hit in newton seconds; 0.1 by default, which stops 100 grams at 1 m/s.
    pub hit_impulse: f32,
}

impl Default for DrapeContactSettings {
    fn default() -> Self {
        Self { max_messages: 256, hit_impulse: 0.1 }
    }
}

/// Number of contacts, and of messages about them in the last step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct DrapeContactCounts {
    /// Current contacts.
    pub touching: usize,
    /// Messages sent.
    pub sent: usize,
    /// Messages held back by [`max_messages`](DrapeContactSettings::max_messages).
    pub held_back: usize,
}
