//! Results of expectations.

use serde::{Deserialize, Serialize};

use crate::scene::Measured;

/// The result of an expectation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The name of the expectation.
    pub title: String,
    /// The probe, in words.
    pub probe: String,
    /// The time or times of measurement, in words.
    pub when: String,
    /// The expected value, in words.
    pub expected: String,
    /// The unit of expected and measured value; empty if they have none.
    pub unit: String,
    /// The measured value: the first that failed, or else the one that came closest to failing. None if it was never
    /// measured.
    pub got: Option<Measured>,
    /// The time of that value in seconds.
    pub time: Option<f64>,
    /// True if the expectation holds. Values that are only reported pass.
    pub passed: bool,
    /// True if the value is only reported.
    pub is_report: bool,
}

impl core::fmt::Display for Verdict {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { title, probe, when, expected, unit, got, time, passed, is_report } = self;
        let mark = match (is_report, passed) {
            (true, _) => "info",
            (false, true) => "ok  ",
            (false, false) => "FAIL",
        };
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        write!(f, "{mark} {title}: ")?;
        if title != probe {
            write!(f, "{probe} ")?;
        }
        if *is_report {
            write!(f, "{when}, a report only: ")?;
        } else {
            write!(f, "{when}: expected {expected}{unit}, ")?;
        }
        match (got, time) {
            (Some(got), Some(time)) => write!(f, "got {got}{unit} at {time:.3} s"),
            _ => f.write_str("it was never there to be measured"),
        }
    }
}
