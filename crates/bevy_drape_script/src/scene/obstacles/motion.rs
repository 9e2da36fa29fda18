//! Motions of obstacles.

use bevy::prelude::*;
use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Number, Positive, Seconds, Shape, Turn, Vector};

/// The motion of an obstacle, which carries bodies along by friction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum Motion {
    /// Stands still.
    #[default]
    Static,
    /// A constant velocity, and a constant rotation about its own centre.
    Steady(Steady),
    /// Linear interpolation from key to key.
    Keyframes(Keyframes),
    /// A rigid body that flies, falls, and is pushed by the bodies that it touches.
    Dynamic(Dynamic),
}

/// A motion of constant velocity.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Steady {
    /// Velocity in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// Rotation in degrees per second, about the axis of the obstacle's own `turn`; 0 by default.
    pub degrees_per_second: Number,
}

/// A motion that is interpolated linearly from key to key. Before the first key and after the last it stands still.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Keyframes {
    /// The keys, in the order of their times.
    pub keys: Vec<Keyframe>,
    /// True to start over after the last key; false by default.
    pub repeat: bool,
}

/// Position and rotation of an obstacle at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// Time in seconds.
    pub time: Seconds,
    /// Position in metres.
    pub at: Vector,
    /// Rotation; none by default. Between keys the angle is interpolated, about the axis of the later key.
    #[serde(default)]
    pub turn: Turn,
}

/// The motion of a rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Dynamic {
    /// Mass in kilograms; 1 by default.
    pub mass: Positive,
    /// Principal moments of inertia in kg m^2; those of a solid sphere or box of this mass by default. Other shapes need them.
    pub inertia: Option<(Positive, Positive, Positive)>,
    /// Velocity at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// Angular velocity at the start in rad/s, in world axes; (0, 0, 0) by default.
    pub angular_velocity: Vector,
    /// Factor on gravity; 1 by default.
    pub gravity_scale: Number,
}

impl Default for Dynamic {
    fn default() -> Self {
        Self {
            mass: Positive::known(1.0),
            inertia: None,
            velocity: Vector::default(),
            angular_velocity: Vector::default(),
            gravity_scale: Number::known(1.0),
        }
    }
}

impl Dynamic {
    /// The plugin's component for a solid of this shape; none if its moments of inertia are unknown.
    pub fn component(&self, shape: &Shape) -> Option<drape::environment::DynamicObstacle> {
        let mass = self.mass.get();
        let still = match (&self.inertia, shape) {
            (Some((x, y, z)), _) => {
                drape::environment::DynamicObstacle::new(mass, Vec3::new(x.get(), y.get(), z.get()))
            }
            (None, Shape::Sphere { radius }) => {
                drape::environment::DynamicObstacle::sphere(mass, radius.get())
            }
            (None, Shape::Cuboid { size: (x, y, z) }) => {
                drape::environment::DynamicObstacle::cuboid(mass, Vec3::new(x.get(), y.get(), z.get()))
            }
            (None, _) => return None,
        };
        Some(drape::environment::DynamicObstacle {
            velocity: self.velocity.get(),
            angular_velocity: self.angular_velocity.get(),
            gravity_scale: self.gravity_scale.get(),
            ..still
        })
    }
}

impl Keyframes {
    /// Position and rotation of the obstacle at `time` in seconds; none without keys.
    pub(super) fn place_at(&self, time: f64) -> Option<(Vec3, Quat)> {
        let (first, last) = (self.keys.first()?, self.keys.last()?);
        let period = last.time.get();
        let time = if self.repeat && period > 0.0 { time % period } else { time };
        let next = self.keys.iter().position(|key| key.time.get() > time);
        let (from, to) = match next {
            Some(0) => (first, first),
            Some(next) => (&self.keys[next - 1], &self.keys[next]),
            None => (last, last),
        };
        let span = to.time.get() - from.time.get();
        let part = if span > 0.0 { ((time - from.time.get()) / span) as f32 } else { 1.0 };
        Some((from.at.lerp(to.at.get(), part), from.turn.towards(&to.turn, part).quaternion()))
    }
}
