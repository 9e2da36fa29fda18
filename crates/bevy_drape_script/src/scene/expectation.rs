//! Expectations: what a scene must do.

use core::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Bound, Probe, Seconds, Tolerance};

/// Something that a scene must do: a probe, when it is looked at, and what is expected of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// What it says, in words, for the report; the probe itself if left out.
    #[serde(default)]
    pub name: String,
    /// When it is looked at; at the end by default.
    #[serde(default)]
    pub when: When,
    /// What is measured.
    pub probe: Probe,
    /// What is expected.
    pub expect: Expected,
}

/// When an expectation is looked at.
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
    /// After every step, until it holds once; it fails if it does not until then.
    Eventually {
        /// By when, in seconds from the beginning; until the end if left out.
        #[serde(default)]
        within: Option<Seconds>,
        /// Not before this time, in seconds from the beginning; from the beginning if left out. What is to come to rest after a push was at rest before it.
        #[serde(default)]
        after: Option<Seconds>,
    },
}

/// What is expected of a measured value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Expected {
    /// This value, and no more than the tolerance away.
    Near {
        /// The value.
        value: Bound,
        /// The tolerance, in the same unit.
        tolerance: Tolerance,
    },
    /// From one value to another.
    Between(Bound, Bound),
    /// At most this value.
    AtMost(Bound),
    /// At least this value.
    AtLeast(Bound),
    /// This word: `Active`, `Resting`, `Frozen` or `Culled` for `Activity`, and a hash for `StateHash`.
    Is(String),
    /// Nothing: the value is only reported.
    Reported,
}

/// A value that a probe has measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Measured {
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
}

impl Expected {
    /// How far `measured` is beyond what is expected: below zero, it has that much room; infinite for words that differ and
    /// for what is no number.
    pub fn excess(&self, measured: &Measured) -> f64 {
        let excess = match (self, measured) {
            (Self::Reported, _) => f64::NEG_INFINITY,
            (Self::Near { value, tolerance }, Measured::Number(number)) => {
                (number - value.get()).abs() - tolerance.get()
            }
            // `max` would lose what is not a number.
            (Self::Between(..), Measured::Number(number)) if number.is_nan() => f64::INFINITY,
            (Self::Between(least, greatest), Measured::Number(number)) => {
                (least.get() - number).max(number - greatest.get())
            }
            (Self::AtMost(greatest), Measured::Number(number)) => number - greatest.get(),
            (Self::AtLeast(least), Measured::Number(number)) => least.get() - number,
            (Self::Is(expected), Measured::Word(word)) if expected == word => -1.0,
            _ => f64::INFINITY,
        };
        if excess.is_nan() { f64::INFINITY } else { excess }
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Near { value, tolerance } => write!(f, "{} ± {}", value.get(), tolerance.get()),
            Self::Between(least, greatest) => write!(f, "from {} to {}", least.get(), greatest.get()),
            Self::AtMost(greatest) => write!(f, "at most {}", greatest.get()),
            Self::AtLeast(least) => write!(f, "at least {}", least.get()),
            Self::Is(word) => f.write_str(word),
            Self::Reported => f.write_str("no value, only a report"),
        }
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Seven digits are all that single precision has.
            Self::Number(number) if number.abs() >= 1e-3 && number.abs() < 1e7 || *number == 0.0 => {
                let digits = (6 - number.abs().max(1e-3).log10().floor() as i32).clamp(0, 9) as usize;
                let text = format!("{number:.digits$}");
                let text =
                    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
                f.write_str(text)
            }
            Self::Number(number) => write!(f, "{number:.6e}"),
            Self::Word(word) => f.write_str(word),
        }
    }
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
    /// What it is called in reports.
    pub fn title(&self) -> String {
        if self.name.is_empty() { self.probe.to_string() } else { self.name.clone() }
    }
}
