//! Obstacles.

use bevy::prelude::*;
use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Fraction, Layers, Motion, NonNegative, Number, Shape, Turn, Vector};

/// Something solid that bodies collide with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Its shape.
    pub shape: Shape,
    /// Position at the start in metres; (0, 0, 0) by default.
    #[serde(default)]
    pub at: Vector,
    /// Rotation at the start; none by default.
    #[serde(default)]
    pub turn: Turn,
    /// Its motion; none by default.
    #[serde(default)]
    pub motion: Motion,
    /// Coulomb friction coefficient; 0.5 by default. Two surfaces in contact use the mean of theirs.
    #[serde(default = "usual_friction")]
    pub friction: NonNegative,
    /// Coefficient of static friction; below `friction` (the default) it counts as `friction`.
    #[serde(default)]
    pub static_friction: NonNegative,
    /// Coefficient of restitution against balls, 0 (no bounce, the default) to 1. The mean of this and the ball's counts.
    #[serde(default)]
    pub restitution: Fraction,
    /// True to report contacts without stopping anything; false by default.
    #[serde(default)]
    pub sensor: bool,
    /// Its collision layers and those that it touches; all by default.
    #[serde(default)]
    pub layers: Option<Layers>,
    /// True to report its contacts; false by default.
    #[serde(default)]
    pub contacts: bool,
    /// Name of its material, for pictures; none by default.
    #[serde(default)]
    pub material: Option<String>,
    /// True to exist from the start, false to wait for `Spawn`; true by default.
    #[serde(default = "present")]
    pub present: bool,
}

fn usual_friction() -> NonNegative {
    NonNegative::known(drape::environment::Obstacle::ground().friction)
}

fn present() -> bool {
    true
}

impl Obstacle {
    /// Position and rotation `time` seconds after the start; none for static and dynamic obstacles.
    pub fn place_at(&self, time: f64) -> Option<(Vec3, Quat)> {
        match &self.motion {
            Motion::Static | Motion::Dynamic(_) => None,
            Motion::Steady(steady) => {
                let way = steady.velocity.as_dvec3() * time;
                let angle =
                    f64::from(self.turn.degrees.get()) + f64::from(steady.degrees_per_second.get()) * time;
                let turn = Turn { axis: self.turn.axis, degrees: Number::known(angle as f32) };
                Some(((self.at.as_dvec3() + way).as_vec3(), turn.quaternion()))
            }
            Motion::Keyframes(keyframes) => keyframes.place_at(time),
        }
    }
}
