//! Local winds.

use bevy::prelude::*;
use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bracketed;
use super::{Fraction, Number, Positive, Turn, Vector};

/// A local wind, on top of the global one: a fan, a draught, an explosion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WindZone {
    /// Its shape and size; `Sphere(radius: 2)` by default.
    pub region: WindRegion,
    /// The flow of the air; `Along(0, 0, -5)` by default.
    pub flow: WindFlow,
    /// Outer fraction of the region, from 0 to 1, over which it falls off to nothing; 0.5 by default.
    pub falloff: Fraction,
    /// Position of its centre in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Rotation of the region and its flow; none by default.
    pub turn: Turn,
    /// True to blow from the start, false to wait for `Spawn`; true by default.
    pub present: bool,
}

/// The shape of a wind zone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum WindRegion {
    /// A ball.
    Sphere {
        /// Radius in metres.
        radius: Positive,
    },
    /// A box.
    Cuboid {
        /// Its sides in metres.
        #[serde(deserialize_with = "bracketed")]
        size: (Positive, Positive, Positive),
    },
}

/// The flow of a wind zone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum WindFlow {
    /// A uniform velocity in m/s, rotated with the zone.
    Along(Vector),
    /// Away from the centre at this speed in m/s, or towards it if negative.
    Outwards(Number),
}

impl Default for WindZone {
    fn default() -> Self {
        Self {
            region: WindRegion::Sphere { radius: Positive::known(2.0) },
            flow: WindFlow::Along(Vector::known(Vec3::NEG_Z * 5.0)),
            falloff: Fraction::known(0.5),
            at: Vector::default(),
            turn: Turn::default(),
            present: true,
        }
    }
}

impl WindZone {
    /// Its position and rotation.
    pub fn place(&self) -> Transform {
        Transform { translation: self.at.get(), rotation: self.turn.quaternion(), scale: Vec3::ONE }
    }
}

impl From<&WindZone> for drape::environment::WindZone {
    fn from(zone: &WindZone) -> Self {
        let region = match zone.region {
            WindRegion::Sphere { radius } => drape::environment::WindRegion::Sphere(radius.get()),
            WindRegion::Cuboid { size: (x, y, z) } => {
                drape::environment::WindRegion::Cuboid(Vec3::new(x.get(), y.get(), z.get()) * 0.5)
            }
        };
        let flow = match zone.flow {
            WindFlow::Along(velocity) => drape::environment::WindFlow::Along(velocity.get()),
            WindFlow::Outwards(speed) => drape::environment::WindFlow::Outwards(speed.get()),
        };
        Self { region, flow, falloff: zone.falloff.get() }
    }
}
