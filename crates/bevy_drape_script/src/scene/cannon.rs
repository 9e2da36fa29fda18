//! Cannons.

use bevy::math::DVec3;
use bevy_drape as drape;
use bevy_drape::drape_solver::motion::ballistics;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Balls, NonNegative, Number, Turn, Vector};

/// A cannon. Its balls have its name and a number: `cannon#1` is the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Cannon {
    /// Position in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Rotation; none by default, so that it points along -Z.
    pub turn: Turn,
    /// Its aim; level along -Z by default.
    pub aim: Aim,
    /// Speed of the ball in m/s as it leaves the muzzle; 20 by default.
    pub speed: NonNegative,
    /// Distance to the muzzle along the barrel in metres; 0 by default.
    pub barrel_length: NonNegative,
    /// Its balls. Only the material counts: radius, mass, drag, friction, restitution and rolling resistance.
    pub ball: Balls,
}

impl Default for Cannon {
    fn default() -> Self {
        Self {
            at: Vector::default(),
            turn: Turn::default(),
            aim: Aim::default(),
            speed: NonNegative::known(20.0),
            barrel_length: NonNegative::known(0.0),
            ball: Balls::default(),
        }
    }
}

/// The aim of a cannon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Aim {
    /// By angles.
    Angles {
        /// Angle above the horizon in degrees; 0 by default.
        #[serde(default)]
        elevation: Number,
        /// Angle to the left in degrees; 0 by default.
        #[serde(default)]
        azimuth: Number,
    },
    /// At a point, on the flatter of the two parabolas through it, without drag. Level, if the point is out of range.
    /// For cannons without rotation and barrel.
    Point(Vector),
}

impl Default for Aim {
    fn default() -> Self {
        Self::Angles { elevation: Number::known(0.0), azimuth: Number::known(0.0) }
    }
}

impl Cannon {
    /// The plugin's component, in a world with this gravity.
    pub fn component(&self, gravity: Vector) -> drape::cannon::Cannon {
        let (elevation, azimuth) = match self.aim {
            Aim::Angles { elevation, azimuth } => {
                (f64::from(elevation.get()).to_radians(), f64::from(azimuth.get()).to_radians())
            }
            Aim::Point(target) => {
                let way: DVec3 = target.as_dvec3() - self.at.as_dvec3();
                let distance = (way.x * way.x + way.z * way.z).sqrt();
                let speed = f64::from(self.speed.get());
                let elevation =
                    ballistics::elevation_for(distance, way.y, speed, f64::from(-gravity.y)).unwrap_or(0.0);
                (elevation, libm::atan2(-way.x, -way.z))
            }
        };
        drape::cannon::Cannon {
            elevation: elevation as f32,
            azimuth: azimuth as f32,
            muzzle_speed: self.speed.get(),
            barrel_length: self.barrel_length.get(),
            ball: (&self.ball).into(),
        }
    }
}
