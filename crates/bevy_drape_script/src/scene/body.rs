//! Bodies: whatever moves by itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Balls, Cloth, Rig, Rope};

/// A body: cloth, rope, hand-built rig or balls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum Body {
    /// A rectangular cloth.
    Cloth(Cloth),
    /// A rope or chain.
    Rope(Rope),
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
            Self::Rig(rig) => rig.present,
            Self::Balls(balls) => balls.present,
        }
    }

    /// Whether its contacts are told.
    pub fn tells_contacts(&self) -> bool {
        match self {
            Self::Cloth(cloth) => cloth.contacts,
            Self::Rope(rope) => rope.contacts,
            Self::Rig(_) => false,
            Self::Balls(balls) => balls.contacts,
        }
    }

    /// The name of its material, if it has one.
    pub fn material(&self) -> Option<&str> {
        match self {
            Self::Cloth(cloth) => cloth.material.as_deref(),
            Self::Rope(rope) => rope.material.as_deref(),
            Self::Rig(rig) => rig.material.as_deref(),
            Self::Balls(balls) => balls.material.as_deref(),
        }
    }
}
