//! Balls.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Copies, Fraction, Layers, NonNegative, Positive, Vector};

/// A ball, or an array of equal ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Balls {
    /// Position of the ball, or of the centre of the array, in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Velocity at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// Number and spacing; one ball by default.
    pub copies: Copies,
    /// Name of their material, for pictures; none by default.
    pub material: Option<String>,
    /// Radius in metres; 0.15 by default.
    pub radius: Positive,
    /// Mass in kilograms; 2 by default.
    pub mass: Positive,
    /// Drag of still air in 1/s; 0 by default.
    pub drag: NonNegative,
    /// Coulomb friction coefficient; 0.5 by default. Two surfaces in contact use the mean of theirs.
    pub friction: NonNegative,
    /// Coefficient of static friction; below `friction` (the default) it counts as `friction`.
    pub static_friction: NonNegative,
    /// Coefficient of restitution, 0 (no bounce, the default) to 1. Two in contact use the mean of theirs.
    pub restitution: Fraction,
    /// Rolling resistance: on level ground a rolling ball slows by 5/7 g times this; 0.05 by default.
    pub rolling_resistance: NonNegative,
    /// Their collision layers and those that they touch; all by default.
    pub layers: Option<Layers>,
    /// True to report their contacts; false by default. Hits are always reported.
    pub contacts: bool,
    /// True to exist from the start, false to wait for `Spawn`; true by default.
    pub present: bool,
}

impl Default for Balls {
    fn default() -> Self {
        let plain = drape::ball::Projectile::default();
        Self {
            at: Vector::default(),
            velocity: Vector::known(plain.velocity),
            copies: Copies::default(),
            material: None,
            radius: Positive::known(plain.radius),
            mass: Positive::known(plain.mass),
            drag: NonNegative::known(plain.drag),
            friction: NonNegative::known(plain.friction),
            static_friction: NonNegative::known(plain.static_friction),
            restitution: Fraction::known(plain.restitution),
            rolling_resistance: NonNegative::known(plain.rolling_resistance),
            layers: None,
            contacts: false,
            present: true,
        }
    }
}

impl From<&Balls> for drape::ball::Projectile {
    fn from(balls: &Balls) -> Self {
        Self {
            radius: balls.radius.get(),
            mass: balls.mass.get(),
            velocity: balls.velocity.get(),
            drag: balls.drag.get(),
            friction: balls.friction.get(),
            static_friction: balls.static_friction.get(),
            restitution: balls.restitution.get(),
            rolling_resistance: balls.rolling_resistance.get(),
        }
    }
}
