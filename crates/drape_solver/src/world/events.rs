//! Events of a step of a world.

use thiserror::Error;

use crate::contact::event::{Contact, Touch};
use crate::error::BuildError;
use crate::state::obstacle_motion::Reaction;
use crate::world::id::{BallId, BodyId, MemberId, ObstacleId, WorldId};

/// Everything that happened in the last step of a [`World`](crate::World).
#[derive(Clone, Debug, Default)]
pub struct Events {
    /// Touches of balls, island by island.
    pub touches: Vec<BallTouch>,
    /// Contacts of bodies, balls and obstacles that [report](crate::Body::reports_contacts) them, island by island.
    pub contacts: Vec<ReportedContact>,
    /// Reactions on obstacles that [ask](crate::Obstacle::reporting_reaction) for them: one from each island that was near.
    pub reactions: Vec<ObstacleReaction>,
    /// Bodies and balls that fell asleep.
    pub slept: Vec<MemberId>,
    /// Bodies and balls that woke up.
    pub woken: Vec<MemberId>,
    /// Bodies and balls that could not be stepped and were left out.
    pub faults: Vec<Fault>,
}

/// A touch of a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallTouch {
    /// The ball.
    pub ball: BallId,
    /// The other side.
    pub other: WorldId,
    /// Time, place and impulse. The indices in it are those of the island.
    pub touch: Touch,
}

/// A contact that was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedContact {
    /// The body or ball that touched something.
    pub party: MemberId,
    /// The other side.
    pub other: WorldId,
    /// Time, place and impulse. The indices in it are those of the island.
    pub contact: Contact,
}

/// The push of one island on an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleReaction {
    /// The obstacle.
    pub obstacle: ObstacleId,
    /// The impulses. The index in it is that of the step.
    pub reaction: Reaction,
}

/// Why a body or ball was left out of a step. It stays [culled](crate::Activity::Culled) until it is edited.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// The state of a body is NaN or infinite, by what was put into it.
    #[error("{0:?} holds a position, velocity, force or pin target that is not finite")]
    NonFiniteBody(BodyId),
    /// The state of a ball is NaN or infinite, by what was put into it.
    #[error("{0:?} holds a position, velocity or force that is not finite")]
    NonFiniteBall(BallId),
    /// A setting of a body is outside its range.
    #[error("settings of {body:?}: {source}")]
    BadSettings {
        /// The body.
        body: BodyId,
        /// The setting at fault.
        source: BuildError,
    },
    /// The particles of a body are not those that its topology joins.
    #[error("{body:?} has {particles} particles, but its topology joins {joined}")]
    WrongParticles {
        /// The body.
        body: BodyId,
        /// The number of particles.
        particles: usize,
        /// The number that the topology joins.
        joined: usize,
    },
}

impl Fault {
    /// The body or ball that was left out.
    pub fn member(&self) -> MemberId {
        match *self {
            Self::NonFiniteBall(ball) => ball.into(),
            Self::NonFiniteBody(body)
            | Self::BadSettings { body, .. }
            | Self::WrongParticles { body, .. } => body.into(),
        }
    }
}

impl Events {
    /// Forgets all of them, keeping the memory.
    pub(crate) fn clear(&mut self) {
        self.touches.clear();
        self.contacts.clear();
        self.reactions.clear();
        self.slept.clear();
        self.woken.clear();
        self.faults.clear();
    }
}
