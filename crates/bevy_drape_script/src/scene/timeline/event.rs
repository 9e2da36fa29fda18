//! The timeline: what happens, and when.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Action, Bound, Expected, Names, Positive, Probe, Seconds, Whole};

/// Something that happens: at a time, or as soon as something is the case.
///
/// `(at: 1.5, do: Fire("cannon"))` or `(when: Resting("curtain"), do: Stop)`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// When, in seconds. It happens at the start of the step that begins then.
    #[serde(default)]
    pub at: Option<Seconds>,
    /// What sets it off: it happens at the start of the step after. Of `at` and `when` there is one.
    #[serde(default)]
    pub when: Option<Trigger>,
    /// How often it is done again after that; not at all by default.
    #[serde(default)]
    pub repeat: Option<Repeat>,
    /// What is done.
    #[serde(rename = "do")]
    pub action: Action,
}

/// How often an event is repeated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// Seconds from one time to the next.
    pub every: Positive,
    /// How many times it happens in all, 1 to 100000.
    pub times: Whole<1, 100_000>,
}

/// What sets an event off. Each does so once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Trigger {
    /// All of these are at rest.
    Resting(Names),
    /// A ball touches something.
    Hit {
        /// Which ball, or a cannon with all of its balls; any if left out.
        #[serde(default)]
        of: Names,
        /// What it touches; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// A probe measures what is expected.
    Measured {
        /// What is measured.
        probe: Probe,
        /// What is expected of it.
        expect: Expected,
    },
}

impl Trigger {
    /// The same as a probe and what is expected of it.
    pub fn as_probe(&self) -> (Probe, Expected) {
        match self {
            Self::Resting(of) => (Probe::Activity { of: of.clone() }, Expected::Is("Resting".to_string())),
            Self::Hit { of, on } => {
                (Probe::Hits { of: of.clone(), on: on.clone() }, Expected::AtLeast(Bound::known(1.0)))
            }
            Self::Measured { probe, expect } => (probe.clone(), expect.clone()),
        }
    }
}
