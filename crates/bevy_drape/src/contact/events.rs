//! Messages about contacts: begun, ended, hard hits.

use bevy::prelude::*;
use drape_solver::Feature;

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

/// How two touch in one step. All the particles of a cloth that touch one thing are one contact.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContact {
    /// The body or ball that touches something; of a ball and a cloth, the ball.
    pub body: Entity,
    /// What it touches.
    pub other: Entity,
    /// Simulated time in seconds at which they first touched in this step: interpolated for balls, to the substep for
    /// particles and sensors.
    pub time: f64,
    /// Point of the other's surface: where a cloth was pushed the hardest, or a ball first touched; in a sensor, where a
    /// particle or the ball's centre was found.
    pub point: Vec3,
    /// Unit normal there, from the other towards the body. In a sensor, from its middle to the point.
    pub normal: Vec3,
    /// Sum of the sizes of all normal impulses in this step, in newton seconds; 0 for a sensor.
    pub impulse: f32,
    /// The particle or face at that point. None between a ball and another or an obstacle.
    pub feature: Option<ContactFeature>,
}

/// Sent in the step in which two begin to touch.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Deref)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactStarted(pub DrapeContact);

/// Sent in the step in which the impulse of a contact, new or lasting, rises to
/// [`hit_impulse`](DrapeContactSettings::hit_impulse). It is sent again once the impulse has been below half of that.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Deref)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactHit(pub DrapeContact);

/// Sent when two have not touched for a tenth of a second. What rests goes on touching. An entity may have been despawned
/// by then.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct DrapeContactEnded {
    /// The body or ball that touched something.
    pub body: Entity,
    /// What it touched.
    pub other: Entity,
    /// Simulated time in seconds of the end of the last step in which they touched.
    pub time: f64,
}

/// What is told of contacts.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeContactSettings {
    /// The most messages of the three kinds together that are sent in one step; 256 by default. The start and the end of
    /// a contact then wait for the next step; hits are lost.
    pub max_messages: usize,
    /// The impulse in newton seconds that makes a hit; 0.1 by default: what stops 100 grams at 1 m/s.
    pub hit_impulse: f32,
}

impl Default for DrapeContactSettings {
    fn default() -> Self {
        Self { max_messages: 256, hit_impulse: 0.1 }
    }
}

/// What was told of contacts in the last step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct DrapeContactCounts {
    /// Contacts that last.
    pub touching: usize,
    /// Messages that were sent.
    pub sent: usize,
    /// Messages that were not sent, as there were too many.
    pub held_back: usize,
}
