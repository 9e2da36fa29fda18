//! Events of the timeline.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Action, Bound, Expected, Names, Positive, Probe, Seconds, Whole};

/// An event: an action at a time, or as soon as a trigger fires.
///
/// `(at: 1.5, do: Fire("cannon"))` or `(when: Resting("curtain"), do: Stop)`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Time in seconds. The event happens at the start of the step that begins then.
    #[serde(default)]
    pub at: Option<Seconds>,
    /// Trigger: the event happens at the start of the next step. Give either `at` or `when`.
    #[serde(default)]
    pub when: Option<Trigger>,
    /// Repetition; none by default.
    #[serde(default)]
    pub repeat: Option<Repeat>,
    /// The action.
    #[serde(rename = "do")]
    pub action: Action,
}

/// The repetition of an event.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// Period in seconds.
    pub every: Positive,
    /// Number of times in all, 1 to 100000.
    pub times: Whole<1, 100_000>,
}

/// A trigger of an event. It fires once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Trigger {
    /// All of these are at rest.
    Resting(Names),
    /// A ball touches something.
    Hit {
        /// A ball, or a cannon with all of its balls; any if left out.
        #[serde(default)]
        of: Names,
        /// The thing that it touches; anything if left out.
        #[serde(default)]
        on: Names,
    },
    /// A probe measures an expected value.
    Measured {
        /// The probe.
        probe: Probe,
        /// The expected value.
        expect: Expected,
    },
}

impl Trigger {
    /// The trigger as a probe and its expected value.
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
