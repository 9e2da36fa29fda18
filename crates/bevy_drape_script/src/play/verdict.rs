//! Results of expectations.

use serde::{Deserialize, Serialize};

use crate::scene::Measured;

/// What has become of an expectation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// What the expectation is called.
    pub title: String,
    /// What was measured, in words.
    pub probe: String,
    /// When, in words.
    pub when: String,
    /// What was expected, in words.
    pub expected: String,
    /// The unit of both; empty if they have none.
    pub unit: String,
    /// What was measured: the first value that failed; if none did, the one that came nearest to failing. None if it was
    /// never measured.
    pub got: Option<Measured>,
    /// When that was, in seconds.
    pub time: Option<f64>,
    /// Whether it holds. What is only reported does.
    pub passed: bool,
    /// Whether nothing is expected: the value is only reported.
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
