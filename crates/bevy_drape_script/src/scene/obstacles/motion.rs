//! How obstacles move.

use bevy::prelude::*;
use bevy_drape::prelude as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Number, Positive, Seconds, Shape, Turn, Vector};

/// How an obstacle moves. What it touches is carried along.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum Motion {
    /// Not at all.
    #[default]
    Static,
    /// At a steady velocity, and turning steadily about its own middle.
    Steady(Steady),
    /// Evenly from key to key.
    Keyframes(Keyframes),
    /// By itself: it flies, falls, and is pushed back by what it touches.
    Dynamic(Dynamic),
}

/// A steady motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Steady {
    /// Velocity in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// How far it turns in a second, about the axis of the obstacle's own `turn`, in degrees; 0 by default.
    pub degrees_per_second: Number,
}

/// A motion from key to key, evenly in between. Before the first key it is there, and after the last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Keyframes {
    /// The keys, in the order of their times.
    pub keys: Vec<Keyframe>,
    /// Whether it starts over after the last key; false by default.
    pub repeat: bool,
}

/// Where an obstacle is at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// When, in seconds.
    pub time: Seconds,
    /// Where, in metres.
    pub at: Vector,
    /// How turned; not at all by default. From key to key the angle changes, about the axis of the later one.
    #[serde(default)]
    pub turn: Turn,
}

/// A motion by itself.
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
    /// How much of gravity it feels; 1 by default.
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
    /// The plugin's component for a solid of this shape; none if its moments of inertia are not known.
    pub fn component(&self, shape: &Shape) -> Option<drape::DynamicObstacle> {
        let mass = self.mass.get();
        let still = match (&self.inertia, shape) {
            (Some((x, y, z)), _) => drape::DynamicObstacle::new(mass, Vec3::new(x.get(), y.get(), z.get())),
            (None, Shape::Sphere { radius }) => drape::DynamicObstacle::sphere(mass, radius.get()),
            (None, Shape::Cuboid { size: (x, y, z) }) => {
                drape::DynamicObstacle::cuboid(mass, Vec3::new(x.get(), y.get(), z.get()))
            }
            (None, _) => return None,
        };
        Some(drape::DynamicObstacle {
            velocity: self.velocity.get(),
            angular_velocity: self.angular_velocity.get(),
            gravity_scale: self.gravity_scale.get(),
            ..still
        })
    }
}

impl Keyframes {
    /// Where the obstacle is, and how turned, at `time` in seconds; none without keys.
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
