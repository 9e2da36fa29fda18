//! Probes: what can be measured about a scene.

use core::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Names, Place, Point, Seconds};

/// A measurement at the end of a step. `of` is a name or a list of names; of several, extensive quantities are summed,
/// and of all others the greatest value counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Probe {
    /// Position of a point along an axis, in metres.
    Position {
        /// Its name, or several names.
        of: Names,
        /// The point; the centre of mass by default.
        #[serde(default)]
        point: Point,
        /// Axis; `Length`, the distance from the origin, by default.
        #[serde(default)]
        axis: Axis,
        /// A time in seconds, whose value is subtracted; none by default.
        #[serde(default)]
        since: Option<Seconds>,
    },
    /// Velocity of a point along an axis, in m/s. Verlet integration gives that in the middle of the last substep.
    Velocity {
        /// Its name, or several names.
        of: Names,
        /// The point; the centre of mass by default.
        #[serde(default)]
        point: Point,
        /// Axis; `Length`, the speed, by default.
        #[serde(default)]
        axis: Axis,
        /// A time in seconds, whose value is subtracted; none by default.
        #[serde(default)]
        since: Option<Seconds>,
    },
    /// Distance between two points in metres.
    Distance {
        /// One point.
        from: Place,
        /// The other point.
        to: Place,
    },
    /// Root mean square speed of all free particles, in m/s; of balls, the speed.
    Speed {
        /// Its name, or several names.
        of: Names,
    },
    /// Size of the box around it along an axis, in metres.
    Extent {
        /// Its name, or several names.
        of: Names,
        /// Axis; `Length`, the diagonal, by default.
        #[serde(default)]
        axis: Axis,
    },
    /// Least coordinate of its particles (of balls: of their surface) along an axis, in metres.
    Least {
        /// Its name, or several names.
        of: Names,
        /// Axis: X, Y or Z.
        axis: Axis,
    },
    /// Greatest coordinate of its particles (of balls: of their surface) along an axis, in metres.
    Greatest {
        /// Its name, or several names.
        of: Names,
        /// Axis: X, Y or Z.
        axis: Axis,
    },
    /// Stretch of the structural sticks, as a fraction of their rest length.
    Stretch {
        /// Its name, or several names.
        of: Names,
        /// Statistic over all sticks; `Max` by default.
        #[serde(default)]
        measure: Measure,
    },
    /// Volume inside a closed body, in units of the rest volume; of several, the farthest from 1.
    Volume {
        /// Name or names of bodies with closed meshes.
        of: Names,
    },
    /// Greatest penetration depth of particles (of balls: their surface) into an obstacle or a ball, in metres; 0
    /// without contact.
    Penetration {
        /// Its name, or several names.
        of: Names,
    },
    /// Number of edges, or links of ropes, that pass through faces: of a body itself or of another. Counted in double
    /// precision, apart from the contacts that are to prevent it.
    Crossings {
        /// Its name, or several names; everything, if left out.
        #[serde(default)]
        of: Names,
    },
    /// Energy in joules, with the spin of balls.
    Energy {
        /// Its name, or several names; everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
        /// Kind of energy; `Mechanical`, the sum, by default.
        #[serde(default)]
        kind: Energy,
        /// A time in seconds, whose value is subtracted; none by default.
        #[serde(default)]
        since: Option<Seconds>,
    },
    /// Linear momentum of free particles, balls and dynamic obstacles along an axis, in kg m/s.
    Momentum {
        /// Its name, or several names; everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
        /// Axis; `Length` by default.
        #[serde(default)]
        axis: Axis,
    },
    /// Angular momentum about the origin along an axis, in kg m^2/s, without the spin of balls.
    AngularMomentum {
        /// Its name, or several names; everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
        /// Axis; `Length` by default.
        #[serde(default)]
        axis: Axis,
    },
    /// Activity: `Active`, `Resting`, `Frozen` or `Culled`. A word, to be compared by `Is`.
    Activity {
        /// Its name, or several names: the liveliest counts.
        of: Names,
    },
    /// Number of bodies and balls.
    Count(Counted),
    /// Number of times that balls began to touch something.
    Hits {
        /// Balls, or cannons with all of their balls; all balls if left out.
        #[serde(default)]
        of: Names,
        /// The things that they touched; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// Number of pairs that began to touch. One of each pair needs `contacts: true`.
    Contacts {
        /// One of the two; anything if left out.
        #[serde(default)]
        of: Names,
        /// The other; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// Number of pairs that touch now. One of each pair needs `contacts: true`. Contacts last a tenth of a second
    /// longer than the touch.
    Touching {
        /// One of the two; anything if left out.
        #[serde(default)]
        of: Names,
        /// The other; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// Number of pieces of a body: 1 until something comes off. Pieces that were too small to be kept do not count.
    Pieces {
        /// Its name, or several names.
        of: Names,
    },
    /// Number of sticks that were torn or cut.
    Torn {
        /// Its name, or several names; everything, if left out.
        #[serde(default)]
        of: Names,
    },
    /// Hash of the state, 16 hexadecimal digits. A word, to be compared by `Is`.
    StateHash {
        /// Its name, or several names; everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
    },
    /// Ratio of the step times with one body and with another, each without the other. It is only reported, as no clock
    /// decides whether a scene passes.
    StepTimeRatio {
        /// The body.
        of: String,
        /// The body that it is compared with.
        against: String,
    },
}

/// An axis of the world, or none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Axis {
    /// To the right.
    X,
    /// Upwards.
    Y,
    /// Towards the viewer.
    Z,
    /// The length of the vector.
    #[default]
    Length,
}

/// A statistic of the stretch of all sticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Measure {
    /// Root of the mean square.
    Rms,
    /// The 99th percentile.
    P99,
    /// The greatest.
    #[default]
    Max,
}

/// A kind of energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Energy {
    /// Kinetic energy.
    Kinetic,
    /// Potential energy of height, relative to the origin.
    Potential,
    /// The sum.
    #[default]
    Mechanical,
}

/// The bodies and balls that are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Counted {
    /// All bodies and balls.
    Bodies,
    /// Simulated ones.
    Active,
    /// Resting ones.
    Resting,
    /// Culled ones.
    Culled,
}

impl Probe {
    /// All names that it uses.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::Position { of, .. }
            | Self::Velocity { of, .. }
            | Self::Speed { of }
            | Self::Extent { of, .. }
            | Self::Least { of, .. }
            | Self::Greatest { of, .. }
            | Self::Stretch { of, .. }
            | Self::Volume { of }
            | Self::Penetration { of }
            | Self::Crossings { of }
            | Self::Energy { of, .. }
            | Self::Momentum { of, .. }
            | Self::AngularMomentum { of, .. }
            | Self::Activity { of }
            | Self::Pieces { of }
            | Self::Torn { of }
            | Self::StateHash { of } => of.iter().map(String::as_str).collect(),
            Self::Hits { of, on } | Self::Contacts { of, on } | Self::Touching { of, on } => {
                of.iter().chain(on.iter()).map(String::as_str).collect()
            }
            Self::Distance { from, to } => vec![&from.of, &to.of],
            Self::StepTimeRatio { of, against } => vec![of, against],
            Self::Count(_) => Vec::new(),
        }
    }

    /// The time whose value is subtracted, in seconds.
    pub fn since(&self) -> Option<Seconds> {
        match self {
            Self::Position { since, .. } | Self::Velocity { since, .. } | Self::Energy { since, .. } => {
                *since
            }
            _ => None,
        }
    }

    /// The unit of its values; empty if they have none.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Position { .. }
            | Self::Distance { .. }
            | Self::Extent { .. }
            | Self::Least { .. }
            | Self::Greatest { .. }
            | Self::Penetration { .. } => "m",
            Self::Velocity { .. } | Self::Speed { .. } => "m/s",
            Self::Energy { .. } => "J",
            Self::Momentum { .. } => "kg m/s",
            Self::AngularMomentum { .. } => "kg m^2/s",
            Self::Stretch { .. }
            | Self::Volume { .. }
            | Self::Crossings { .. }
            | Self::Activity { .. }
            | Self::Count(_)
            | Self::Hits { .. }
            | Self::Contacts { .. }
            | Self::Touching { .. }
            | Self::Pieces { .. }
            | Self::Torn { .. }
            | Self::StateHash { .. }
            | Self::StepTimeRatio { .. } => "",
        }
    }
}

impl fmt::Display for Probe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |axis: &Axis| if *axis == Axis::Length { String::new() } else { format!(" along {axis:?}") };
        match self {
            Self::Position { of, point, axis, since } => {
                write!(f, "position of {of} ({point}){}", at(axis))?;
                since.map_or(Ok(()), |since| write!(f, " since {} s", since.get()))
            }
            Self::Velocity { of, point, axis, since } => {
                write!(f, "velocity of {of} ({point}){}", at(axis))?;
                since.map_or(Ok(()), |since| write!(f, " since {} s", since.get()))
            }
            Self::Distance { from, to } => {
                write!(f, "distance from {} ({}) to {} ({})", from.of, from.point, to.of, to.point)
            }
            Self::Speed { of } => write!(f, "speed of {of}"),
            Self::Extent { of, axis } => write!(f, "extent of {of}{}", at(axis)),
            Self::Least { of, axis } => write!(f, "least {axis:?} of {of}"),
            Self::Greatest { of, axis } => write!(f, "greatest {axis:?} of {of}"),
            Self::Stretch { of, measure } => write!(f, "{measure:?} stretch of {of}"),
            Self::Volume { of } => write!(f, "volume of {of}"),
            Self::Penetration { of } => write!(f, "penetration of {of}"),
            Self::Crossings { of } => write!(f, "crossings of {of}"),
            Self::Energy { of, kind, since } => {
                write!(f, "{kind:?} energy of {of}")?;
                since.map_or(Ok(()), |since| write!(f, " since {} s", since.get()))
            }
            Self::Momentum { of, axis } => write!(f, "momentum of {of}{}", at(axis)),
            Self::AngularMomentum { of, axis } => write!(f, "angular momentum of {of}{}", at(axis)),
            Self::Activity { of } => write!(f, "activity of {of}"),
            Self::Count(counted) => write!(f, "count of {counted:?}"),
            Self::Hits { of, on } => write!(f, "hits of {of} on {on}"),
            Self::Contacts { of, on } => write!(f, "contacts of {of} and {on}"),
            Self::Touching { of, on } => write!(f, "pairs of {of} and {on} that touch"),
            Self::Pieces { of } => write!(f, "pieces of {of}"),
            Self::Torn { of } => write!(f, "torn sticks of {of}"),
            Self::StateHash { of } => write!(f, "state hash of {of}"),
            Self::StepTimeRatio { of, against } => write!(f, "step time of {of} against {against}"),
        }
    }
}
