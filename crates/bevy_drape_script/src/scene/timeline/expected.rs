//! Measured values, and the values expected of them.

use core::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Bound, Tolerance};

/// The expectation of a measured value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Expected {
    /// Within a tolerance of a value.
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
    /// The distance of `measured` beyond the expectation: negative if there is room left, infinite for words that
    /// differ and for NaN.
    pub fn excess(&self, measured: &Measured) -> f64 {
        let excess = match (self, measured) {
            (Self::Reported, _) => f64::NEG_INFINITY,
            (Self::Near { value, tolerance }, Measured::Number(number)) => {
                (number - value.get()).abs() - tolerance.get()
            }
            // `max` would drop the NaN.
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
            // Single precision has no more than seven digits.
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
