//! Soft balls.

use bevy_drape::prelude as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Fraction, Layers, NonNegative, Positive, Solver, Tearable, Turn, Vector, Whole};

/// A soft ball of rings of particles. Untouched by `turn` it lies in the XY plane, in which it stays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SoftBall {
    /// Radius in metres; 0.25 by default.
    pub radius: Positive,
    /// Number of rings, 1 to 256: ring k has 10 k particles; 4 by default.
    pub rings: Whole<1, 256>,
    /// Mass per area in kg/m^2; 10 by default.
    pub areal_density: Positive,
    /// Stiffness of all sticks, 0 (slack) to 1 (rigid); 0.999 by default.
    pub stiffness: Fraction,
    /// Damping along the sticks in 1/s; 1 by default.
    pub damping: NonNegative,
    /// Whether its outmost ring is fixed; false by default.
    pub pin_rim: bool,
    /// Where its middle is, in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// How it is turned; not at all by default.
    pub turn: Turn,
    /// Velocity of its free particles at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// When it tears; never by default.
    pub tearable: Option<Tearable>,
    /// How it is solved; as the scene's settings have it by default.
    pub solver: Solver,
    /// Which layers it is in and which it touches; all by default.
    pub layers: Option<Layers>,
    /// Whether its contacts are told; false by default.
    pub contacts: bool,
    /// Name of its material, for pictures; none by default.
    pub material: Option<String>,
    /// Whether it is there at the start, and not only once it is spawned; true by default.
    pub present: bool,
}

impl Default for SoftBall {
    fn default() -> Self {
        let plain = drape::SoftBall::default();
        Self {
            radius: Positive::known(plain.radius),
            rings: Whole::known(plain.rings),
            areal_density: Positive::known(plain.areal_density),
            stiffness: Fraction::known(plain.stiffness),
            damping: NonNegative::known(plain.damping),
            pin_rim: plain.pin_rim,
            at: Vector::default(),
            turn: Turn::default(),
            velocity: Vector::default(),
            tearable: None,
            solver: Solver::default(),
            layers: None,
            contacts: false,
            material: None,
            present: true,
        }
    }
}

impl SoftBall {
    /// How many particles it has.
    pub fn particle_count(&self) -> u32 {
        5 * self.rings.get() * (self.rings.get() + 1)
    }
}

impl From<&SoftBall> for drape::SoftBall {
    fn from(ball: &SoftBall) -> Self {
        Self {
            radius: ball.radius.get(),
            rings: ball.rings.get(),
            areal_density: ball.areal_density.get(),
            stiffness: ball.stiffness.get(),
            damping: ball.damping.get(),
            pin_rim: ball.pin_rim,
        }
    }
}
