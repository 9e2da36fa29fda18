//! Points of bodies and obstacles.

use core::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A point of a body.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Point {
    /// The centre of mass of all free particles; of an obstacle, its origin.
    #[default]
    Centre,
    /// A particle by its number, from 0: of cloths row by row from the top left, of ropes from the start, of rigs in
    /// the order of their names.
    Particle(u32),
    /// The first particle.
    First,
    /// The middle particle: of a whole cloth that of the middle row and column, of all other bodies half way from the
    /// first to the last.
    Middle,
    /// The last particle.
    Last,
}

/// A point of something in the scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Name of the body, ball or obstacle.
    pub of: String,
    /// The point; the centre of mass by default.
    #[serde(default)]
    pub point: Point,
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Centre => f.write_str("centre"),
            Self::Particle(number) => write!(f, "particle {number}"),
            Self::First => f.write_str("first"),
            Self::Middle => f.write_str("middle"),
            Self::Last => f.write_str("last"),
        }
    }
}
