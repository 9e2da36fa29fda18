//! Probes: what can be measured about a scene.

use core::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Names, Place, Point, Seconds};

/// What is measured, at the end of a step. `of` is a name or a list of names; of several, what can be summed is summed, and
/// of the rest the greatest is taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Probe {
    /// Position of a point along an axis, in metres.
    Position {
        /// Whose.
        of: Names,
        /// Which point of it; the centre of mass by default.
        #[serde(default)]
        point: Point,
        /// Along which axis; `Length`, the distance from the origin, by default.
        #[serde(default)]
        axis: Axis,
        /// A time in seconds whose value is taken off: how far it has come since then.
        #[serde(default)]
        since: Option<Seconds>,
    },
    /// Velocity of a point along an axis, in m/s: as Verlet has it, that in the middle of the last substep.
    Velocity {
        /// Whose.
        of: Names,
        /// Which point of it; the centre of mass by default.
        #[serde(default)]
        point: Point,
        /// Along which axis; `Length`, the speed, by default.
        #[serde(default)]
        axis: Axis,
        /// A time in seconds whose value is taken off: how much it has changed since then.
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
        /// Whose.
        of: Names,
    },
    /// Size of the box around it along an axis, in metres.
    Extent {
        /// Whose.
        of: Names,
        /// Along which axis; `Length`, the diagonal, by default.
        #[serde(default)]
        axis: Axis,
    },
    /// Least coordinate of its particles (of balls: of their surface) along an axis, in metres.
    Least {
        /// Whose.
        of: Names,
        /// Along which axis: X, Y or Z.
        axis: Axis,
    },
    /// Greatest coordinate of its particles (of balls: of their surface) along an axis, in metres.
    Greatest {
        /// Whose.
        of: Names,
        /// Along which axis: X, Y or Z.
        axis: Axis,
    },
    /// Stretch of the structural sticks, as a fraction of their rest length.
    Stretch {
        /// Whose.
        of: Names,
        /// Which figure of all its sticks; `Max` by default.
        #[serde(default)]
        measure: Measure,
    },
    /// The volume inside a closed body, in parts of that at rest; of several, the farthest from 1.
    Volume {
        /// Whose: of what is made of a closed mesh.
        of: Names,
    },
    /// How deep its deepest particle (of balls: their surface) lies in an obstacle or a ball, in metres; 0 where it touches
    /// nothing.
    Penetration {
        /// Whose.
        of: Names,
    },
    /// Energy in joules; balls with their spin.
    Energy {
        /// Whose; of everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
        /// Which energy; `Mechanical`, the sum, by default.
        #[serde(default)]
        kind: Energy,
        /// A time in seconds whose value is taken off: how much it has changed since then.
        #[serde(default)]
        since: Option<Seconds>,
    },
    /// Linear momentum of what is free along an axis, in kg m/s.
    Momentum {
        /// Whose; of everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
        /// Along which axis; `Length` by default.
        #[serde(default)]
        axis: Axis,
    },
    /// Angular momentum of the particles about the origin along an axis, in kg m^2/s; balls without their spin.
    AngularMomentum {
        /// Whose; of everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
        /// Along which axis; `Length` by default.
        #[serde(default)]
        axis: Axis,
    },
    /// Whether it is `Active`, `Resting` or `Culled`: a word, to be expected with `Is`.
    Activity {
        /// Whose; of several, that of the liveliest.
        of: Names,
    },
    /// A number of bodies and balls.
    Count(Counted),
    /// How often balls began to touch something.
    Hits {
        /// Which balls, or a cannon with all of its balls; all if left out.
        #[serde(default)]
        of: Names,
        /// What they touched; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// How many pairs began to touch, of what has `contacts: true` or touches something that has.
    Contacts {
        /// One of the two; anything if left out.
        #[serde(default)]
        of: Names,
        /// The other; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// How many pairs touch now, of what has `contacts: true` or touches something that has. They go on touching for a tenth of a
    /// second after they parted.
    Touching {
        /// One of the two; anything if left out.
        #[serde(default)]
        of: Names,
        /// The other; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// Of how many pieces a body is: 1 until something comes off it. Those that were too small to be kept do not count.
    Pieces {
        /// Whose.
        of: Names,
    },
    /// How many sticks were torn or cut.
    Torn {
        /// Whose; of everything, if left out.
        #[serde(default)]
        of: Names,
    },
    /// A word of 16 hexadecimal digits that tells two states apart, to be expected with `Is`.
    StateHash {
        /// Whose; of everything that moves by itself, if left out.
        #[serde(default)]
        of: Names,
    },
    /// How long a step takes with one body as a multiple of a step with another, each in a scene without the other. It is
    /// reported and never fails, as a clock is no law.
    StepTimeRatio {
        /// The body.
        of: String,
        /// What it is compared with.
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

/// A figure of the stretch of all sticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Measure {
    /// Root of the mean square.
    Rms,
    /// What 99 of 100 stay below.
    P99,
    /// The greatest.
    #[default]
    Max,
}

/// A kind of energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Energy {
    /// Of motion.
    Kinetic,
    /// Of height, from the origin.
    Potential,
    /// The sum.
    #[default]
    Mechanical,
}

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Counted {
    /// All bodies and balls.
    Bodies,
    /// Those that are simulated.
    Active,
    /// Those at rest.
    Resting,
    /// Those that are culled.
    Culled,
}

impl Probe {
    /// Everything that it names.
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

    /// The time from which on it counts, if it counts from one.
    pub fn since(&self) -> Option<Seconds> {
        match self {
            Self::Position { since, .. } | Self::Velocity { since, .. } | Self::Energy { since, .. } => {
                *since
            }
            _ => None,
        }
    }

    /// The unit of what it measures; empty for what has none.
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
