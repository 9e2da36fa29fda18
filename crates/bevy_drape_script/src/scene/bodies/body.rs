//! Bodies: whatever moves by itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{
    Balls, Cloth, ClothMesh, Layers, MeshSource, Rig, Rope, SoftBall, SoftBody, Solver, Surface, Tearable,
    Turn, Vector,
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

/// The same expression for every kind of body.
macro_rules! of_each {
    ($self:ident, $body:ident => $value:expr) => {
        match $self {
            Self::Cloth($body) => $value,
            Self::Rope($body) => $value,
            Self::ClothMesh($body) => $value,
            Self::SoftBall($body) => $value,
            Self::SoftBody($body) => $value,
            Self::Rig($body) => $value,
            Self::Balls($body) => $value,
        }
    };
}

impl Body {
    /// Returns true if it exists from the start.
    pub fn is_present(&self) -> bool {
        of_each!(self, body => body.present)
    }

    /// Returns true if it reports its contacts.
    pub fn reports_contacts(&self) -> bool {
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
        of_each!(self, body => body.material.as_deref())
    }

    /// Its solver settings; none for balls.
    pub fn solver(&self) -> Option<&Solver> {
        self.solver_and_surface().map(|(solver, _)| solver)
    }

    /// Its surface; none for balls, which have fields of their own for that.
    pub fn surface(&self) -> Option<&Surface> {
        self.solver_and_surface().map(|(_, surface)| surface)
    }

    fn solver_and_surface(&self) -> Option<(&Solver, &Surface)> {
        match self {
            Self::Cloth(cloth) => Some((&cloth.solver, &cloth.surface)),
            Self::Rope(rope) => Some((&rope.solver, &rope.surface)),
            Self::ClothMesh(cloth) => Some((&cloth.solver, &cloth.surface)),
            Self::SoftBall(ball) => Some((&ball.solver, &ball.surface)),
            Self::SoftBody(solid) => Some((&solid.solver, &solid.surface)),
            Self::Rig(rig) => Some((&rig.solver, &rig.surface)),
            Self::Balls(_) => None,
        }
    }

    /// Its tearing limits, if it tears.
    pub fn tearable(&self) -> Option<&Tearable> {
        match self {
            Self::Cloth(cloth) => cloth.tearable.as_ref(),
            Self::Rope(rope) => rope.tearable.as_ref(),
            Self::ClothMesh(cloth) => cloth.tearable.as_ref(),
            Self::SoftBall(ball) => ball.tearable.as_ref(),
            Self::SoftBody(_) | Self::Rig(_) | Self::Balls(_) => None,
        }
    }

    /// Returns true if it can be cut.
    pub fn can_be_cut(&self) -> bool {
        matches!(self, Self::Cloth(_) | Self::Rope(_) | Self::ClothMesh(_) | Self::SoftBall(_))
    }

    /// The mesh that it is built from, if there is one.
    pub fn mesh(&self) -> Option<&MeshSource> {
        match self {
            Self::ClothMesh(cloth) => Some(&cloth.mesh),
            Self::SoftBody(solid) => Some(&solid.mesh),
            _ => None,
        }
    }

    /// Position and rotation; none for ropes, rigs and balls, which have no place as a whole.
    pub fn place(&self) -> Option<(Vector, &Turn)> {
        match self {
            Self::Cloth(cloth) => Some((cloth.at, &cloth.turn)),
            Self::ClothMesh(cloth) => Some((cloth.at, &cloth.turn)),
            Self::SoftBall(ball) => Some((ball.at, &ball.turn)),
            Self::SoftBody(solid) => Some((solid.at, &solid.turn)),
            Self::Rope(_) | Self::Rig(_) | Self::Balls(_) => None,
        }
    }

    /// Velocity of its free particles at the start in m/s.
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

    /// Its collision layers; none stands for all.
    pub fn layers(&self) -> Option<&Layers> {
        of_each!(self, body => body.layers.as_ref())
    }
}
