//! Soft balls.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Fraction, Layers, NonNegative, Positive, Solver, Surface, Tearable, Turn, Vector, Whole};

/// A two-dimensional soft ball of rings of particles. Without a `turn` it lies in the XY plane, in which it stays.
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
    /// True to fix its outermost ring; false by default.
    pub pin_rim: bool,
    /// Position of its centre in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Rotation; none by default.
    pub turn: Turn,
    /// Velocity of its free particles at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// Tearing limits; never tears by default.
    pub tearable: Option<Tearable>,
    /// Solver settings; those of the scene by default.
    pub solver: Solver,
    /// Its surface; that of the scene by default.
    pub surface: Surface,
    /// Its collision layers and those that it touches; all by default.
    pub layers: Option<Layers>,
    /// True to report its contacts; false by default.
    pub contacts: bool,
    /// Name of its material, for pictures; none by default.
    pub material: Option<String>,
    /// True to exist from the start, false to wait for `Spawn`; true by default.
    pub present: bool,
}

impl Default for SoftBall {
    fn default() -> Self {
        let plain = drape::build::SoftBall::default();
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
            surface: Surface::default(),
            layers: None,
            contacts: false,
            material: None,
            present: true,
        }
    }
}

impl SoftBall {
    /// Number of particles.
    pub fn particle_count(&self) -> u32 {
        5 * self.rings.get() * (self.rings.get() + 1)
    }
}

impl From<&SoftBall> for drape::build::SoftBall {
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
