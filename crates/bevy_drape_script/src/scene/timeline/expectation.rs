//! Expectations: values that a scene must reach or keep.

use core::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Expected, Probe, Seconds};

/// An expectation: a probe, the time of its measurement, and the expected value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// Name in reports; the probe itself if left out.
    #[serde(default)]
    pub name: String,
    /// When it is evaluated; at the end by default.
    #[serde(default)]
    pub when: When,
    /// The probe.
    pub probe: Probe,
    /// The expected value.
    pub expect: Expected,
}

/// When an expectation is evaluated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum When {
    /// After the last step.
    #[default]
    End,
    /// After the step that ends at this time, in seconds.
    At(Seconds),
    /// After every step.
    Always,
    /// After every step from one time to another, in seconds.
    During(Seconds, Seconds),
    /// After every step until it holds once; it fails if it never does.
    Eventually {
        /// Latest time in seconds from the beginning; the end if left out.
        #[serde(default)]
        within: Option<Seconds>,
        /// Earliest time in seconds from the beginning; the beginning if left out. For a body that has to come to rest
        /// after a push, but was at rest before it.
        #[serde(default)]
        after: Option<Seconds>,
    },
}

impl fmt::Display for When {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::End => f.write_str("at the end"),
            Self::At(time) => write!(f, "at {} s", time.get()),
            Self::Always => f.write_str("always"),
            Self::During(from, to) => write!(f, "at every step from {} s to {} s", from.get(), to.get()),
            Self::Eventually { within, after } => {
                match within {
                    Some(time) => write!(f, "within {} s", time.get())?,
                    None => f.write_str("eventually")?,
                }
                after.map_or(Ok(()), |after| write!(f, ", after {} s", after.get()))
            }
        }
    }
}

impl Expectation {
    /// Its name in reports.
    pub fn title(&self) -> String {
        if self.name.is_empty() { self.probe.to_string() } else { self.name.clone() }
    }
}
