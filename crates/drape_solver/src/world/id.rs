//! The names of what is in a world.

use crate::world::resting_tree::Key;
use crate::world::slots::SlotKey;

/// The name of a body in a [`World`](crate::World). Never used again for another body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub(crate) SlotKey);

/// The name of a ball in a [`World`](crate::World). Never used again for another ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BallId(pub(crate) SlotKey);

/// The name of an obstacle in a [`World`](crate::World). Never used again for another obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ObstacleId(pub(crate) SlotKey);

/// The name of anything in a [`World`](crate::World).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum WorldId {
    /// A body.
    Body(BodyId),
    /// A ball.
    Ball(BallId),
    /// An obstacle.
    Obstacle(ObstacleId),
}

impl From<BodyId> for WorldId {
    fn from(id: BodyId) -> Self {
        Self::Body(id)
    }
}

impl From<BallId> for WorldId {
    fn from(id: BallId) -> Self {
        Self::Ball(id)
    }
}

impl From<ObstacleId> for WorldId {
    fn from(id: ObstacleId) -> Self {
        Self::Obstacle(id)
    }
}

/// A body or ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum MemberId {
    /// A body.
    Body(BodyId),
    /// A ball.
    Ball(BallId),
}

impl From<BodyId> for MemberId {
    fn from(id: BodyId) -> Self {
        Self::Body(id)
    }
}

impl From<BallId> for MemberId {
    fn from(id: BallId) -> Self {
        Self::Ball(id)
    }
}

impl From<MemberId> for WorldId {
    fn from(id: MemberId) -> Self {
        match id {
            MemberId::Body(id) => Self::Body(id),
            MemberId::Ball(id) => Self::Ball(id),
        }
    }
}

impl Key for MemberId {
    fn index(self) -> usize {
        match self {
            Self::Body(BodyId(slot)) | Self::Ball(BallId(slot)) => slot.index as usize,
        }
    }
}
