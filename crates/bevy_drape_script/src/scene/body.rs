//! Bodies: whatever moves by itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Balls, Cloth, Rig, Rope, SoftBall, Solver, Tearable};

/// A body: cloth, rope, soft ball, hand-built rig or balls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum Body {
    /// A rectangular cloth.
    Cloth(Cloth),
    /// A rope or chain.
    Rope(Rope),
    /// A soft ball in a plane.
    SoftBall(SoftBall),
    /// Particles and sticks, built by hand.
    Rig(Rig),
    /// A ball, or an array of equal ones.
    Balls(Balls),
}

impl Body {
    /// Whether it is there when the scene begins.
    pub fn is_present(&self) -> bool {
        match self {
            Self::Cloth(cloth) => cloth.present,
            Self::Rope(rope) => rope.present,
            Self::SoftBall(ball) => ball.present,
            Self::Rig(rig) => rig.present,
            Self::Balls(balls) => balls.present,
        }
    }

    /// Whether its contacts are told.
    pub fn tells_contacts(&self) -> bool {
        match self {
            Self::Cloth(cloth) => cloth.contacts,
            Self::Rope(rope) => rope.contacts,
            Self::SoftBall(ball) => ball.contacts,
            Self::Rig(_) => false,
            Self::Balls(balls) => balls.contacts,
        }
    }

    /// The name of its material, if it has one.
    pub fn material(&self) -> Option<&str> {
        match self {
            Self::Cloth(cloth) => cloth.material.as_deref(),
            Self::Rope(rope) => rope.material.as_deref(),
            Self::SoftBall(ball) => ball.material.as_deref(),
            Self::Rig(rig) => rig.material.as_deref(),
            Self::Balls(balls) => balls.material.as_deref(),
        }
    }

    /// How it is solved, if it says so itself.
    pub fn solver(&self) -> Option<&Solver> {
        match self {
            Self::Cloth(cloth) => Some(&cloth.solver),
            Self::Rope(rope) => Some(&rope.solver),
            Self::SoftBall(ball) => Some(&ball.solver),
            Self::Rig(rig) => Some(&rig.solver),
            Self::Balls(_) => None,
        }
    }

    /// When it tears, if it does.
    pub fn tearable(&self) -> Option<&Tearable> {
        match self {
            Self::Cloth(cloth) => cloth.tearable.as_ref(),
            Self::Rope(rope) => rope.tearable.as_ref(),
            Self::SoftBall(ball) => ball.tearable.as_ref(),
            Self::Rig(_) | Self::Balls(_) => None,
        }
    }

    /// Whether a cut may part it.
    pub fn can_be_cut(&self) -> bool {
        matches!(self, Self::Cloth(_) | Self::Rope(_) | Self::SoftBall(_))
    }
}
