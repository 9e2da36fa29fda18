//! Hand-built rigs.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Fraction, Layers, Named, NonNegative, Positive, Solver, Surface, Vector};

/// Particles and sticks, built by hand. Particles are numbered in the order of their names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Rig {
    /// The particles by name.
    pub particles: Named<RigParticle>,
    /// The sticks that join them.
    pub sticks: Vec<RigStick>,
    /// Position of the rig's origin in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Solver settings; those of the scene by default.
    pub solver: Solver,
    /// Its surface; that of the scene by default.
    pub surface: Surface,
    /// Its collision layers and those that it touches; all by default.
    pub layers: Option<Layers>,
    /// Name of its material, for pictures; none by default.
    pub material: Option<String>,
    /// True to exist from the start, false to wait for `Spawn`; true by default.
    pub present: bool,
}

impl Default for Rig {
    fn default() -> Self {
        Self {
            particles: Named::default(),
            sticks: Vec::new(),
            at: Vector::default(),
            solver: Solver::default(),
            surface: Surface::default(),
            layers: None,
            material: None,
            present: true,
        }
    }
}

/// A particle of a rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RigParticle {
    /// Position relative to the rig's origin in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Mass in kilograms; 1 by default.
    pub mass: Positive,
    /// True to fix it; false by default.
    pub pinned: bool,
    /// Velocity at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
}

impl Default for RigParticle {
    fn default() -> Self {
        let drape::rig::Particle { mass, pinned, velocity } = drape::rig::Particle::default();
        Self { at: Vector::default(), mass: Positive::known(mass), pinned, velocity: Vector::known(velocity) }
    }
}

impl From<&RigParticle> for drape::rig::Particle {
    fn from(particle: &RigParticle) -> Self {
        Self { mass: particle.mass.get(), pinned: particle.pinned, velocity: particle.velocity.get() }
    }
}

/// A stick of a rig: `(a: "hook", b: "bob")`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigStick {
    /// Name of the particle at one end.
    pub a: String,
    /// Name of the particle at the other end.
    pub b: String,
    /// Rest length in metres; the distance between its ends by default.
    #[serde(default)]
    pub rest_length: Option<Positive>,
    /// Stiffness from 0 (slack) to 1 (rigid, the default).
    #[serde(default = "rigid")]
    pub stiffness: Fraction,
    /// Damping along the stick in 1/s; 0 by default.
    #[serde(default)]
    pub damping: NonNegative,
    /// Its purpose; `Structural` by default.
    #[serde(default)]
    pub kind: StickKind,
    /// The lengths that it allows; `Exact` by default.
    #[serde(default)]
    pub bound: StickBound,
}

fn rigid() -> Fraction {
    Fraction::known(1.0)
}

/// The purpose of a stick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StickKind {
    /// Carries load.
    #[default]
    Structural,
    /// A diagonal.
    Shear,
    /// Keeps a chain from folding. Balls pass through it.
    Bend,
}

impl From<StickKind> for drape::rig::StickKind {
    fn from(kind: StickKind) -> Self {
        match kind {
            StickKind::Structural => Self::Structural,
            StickKind::Shear => Self::Shear,
            StickKind::Bend => Self::Bend,
        }
    }
}

/// The lengths that a stick allows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StickBound {
    /// The rest length alone: a rod.
    #[default]
    Exact,
    /// The rest length and more.
    AtLeast,
    /// The rest length and less: a cord.
    AtMost,
}

impl From<StickBound> for drape::rig::StickBound {
    fn from(bound: StickBound) -> Self {
        match bound {
            StickBound::Exact => Self::Exact,
            StickBound::AtLeast => Self::AtLeast,
            StickBound::AtMost => Self::AtMost,
        }
    }
}
