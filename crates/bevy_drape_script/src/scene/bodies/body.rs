//! Bodies: whatever moves by itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{
    Balls, Cloth, ClothMesh, Layers, MeshSource, Rig, Rope, SoftBall, SoftBody, Solver, Tearable, Turn,
    Vector,
};

/// A body: cloth, rope, soft ball, soft solid, hand-built rig or balls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum Body {
    /// A rectangular cloth.
    Cloth(Cloth),
    /// A rope or chain.
    Rope(Rope),
    /// A cloth from any mesh.
    ClothMesh(ClothMesh),
    /// A soft ball in a plane.
    SoftBall(SoftBall),
    /// A soft solid of any closed mesh.
    SoftBody(SoftBody),
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
            Self::ClothMesh(cloth) => cloth.present,
            Self::SoftBall(ball) => ball.present,
            Self::SoftBody(solid) => solid.present,
            Self::Rig(rig) => rig.present,
            Self::Balls(balls) => balls.present,
        }
    }

    /// Whether its contacts are told.
    pub fn tells_contacts(&self) -> bool {
        match self {
            Self::Cloth(cloth) => cloth.contacts,
            Self::Rope(rope) => rope.contacts,
            Self::ClothMesh(cloth) => cloth.contacts,
            Self::SoftBall(ball) => ball.contacts,
            Self::SoftBody(solid) => solid.contacts,
            Self::Rig(_) => false,
            Self::Balls(balls) => balls.contacts,
        }
    }

    /// The name of its material, if it has one.
    pub fn material(&self) -> Option<&str> {
        match self {
            Self::Cloth(cloth) => cloth.material.as_deref(),
            Self::Rope(rope) => rope.material.as_deref(),
            Self::ClothMesh(cloth) => cloth.material.as_deref(),
            Self::SoftBall(ball) => ball.material.as_deref(),
            Self::SoftBody(solid) => solid.material.as_deref(),
            Self::Rig(rig) => rig.material.as_deref(),
            Self::Balls(balls) => balls.material.as_deref(),
        }
    }

    /// How it is solved, if it says so itself.
    pub fn solver(&self) -> Option<&Solver> {
        match self {
            Self::Cloth(cloth) => Some(&cloth.solver),
            Self::Rope(rope) => Some(&rope.solver),
            Self::ClothMesh(cloth) => Some(&cloth.solver),
            Self::SoftBall(ball) => Some(&ball.solver),
            Self::SoftBody(solid) => Some(&solid.solver),
            Self::Rig(rig) => Some(&rig.solver),
            Self::Balls(_) => None,
        }
    }

    /// When it tears, if it does.
    pub fn tearable(&self) -> Option<&Tearable> {
        match self {
            Self::Cloth(cloth) => cloth.tearable.as_ref(),
            Self::Rope(rope) => rope.tearable.as_ref(),
            Self::ClothMesh(cloth) => cloth.tearable.as_ref(),
            Self::SoftBall(ball) => ball.tearable.as_ref(),
            Self::SoftBody(_) | Self::Rig(_) | Self::Balls(_) => None,
        }
    }

    /// Whether a cut may part it.
    pub fn can_be_cut(&self) -> bool {
        matches!(self, Self::Cloth(_) | Self::Rope(_) | Self::ClothMesh(_) | Self::SoftBall(_))
    }

    /// The mesh that it is made of, if it is made of one.
    pub fn mesh(&self) -> Option<&MeshSource> {
        match self {
            Self::ClothMesh(cloth) => Some(&cloth.mesh),
            Self::SoftBody(solid) => Some(&solid.mesh),
            _ => None,
        }
    }

    /// Where it is and how it is turned, if it says so as a whole.
    pub fn place(&self) -> Option<(Vector, &Turn)> {
        match self {
            Self::Cloth(cloth) => Some((cloth.at, &cloth.turn)),
            Self::ClothMesh(cloth) => Some((cloth.at, &cloth.turn)),
            Self::SoftBall(ball) => Some((ball.at, &ball.turn)),
            Self::SoftBody(solid) => Some((solid.at, &solid.turn)),
            Self::Rope(_) | Self::Rig(_) | Self::Balls(_) => None,
        }
    }

    /// Velocity of its free particles at the start.
    pub fn velocity(&self) -> Vector {
        match self {
            Self::Cloth(cloth) => cloth.velocity,
            Self::Rope(rope) => rope.velocity,
            Self::ClothMesh(cloth) => cloth.velocity,
            Self::SoftBall(ball) => ball.velocity,
            Self::SoftBody(solid) => solid.velocity,
            Self::Balls(balls) => balls.velocity,
            Self::Rig(_) => Vector::default(),
        }
    }

    /// Its layers, if they are others than all.
    pub fn layers(&self) -> Option<&Layers> {
        match self {
            Self::Cloth(cloth) => cloth.layers.as_ref(),
            Self::Rope(rope) => rope.layers.as_ref(),
            Self::ClothMesh(cloth) => cloth.layers.as_ref(),
            Self::SoftBall(ball) => ball.layers.as_ref(),
            Self::SoftBody(solid) => solid.layers.as_ref(),
            Self::Rig(rig) => rig.layers.as_ref(),
            Self::Balls(balls) => balls.layers.as_ref(),
        }
    }
}
