//! Judges: each looks at one expectation.

use serde::{Deserialize, Serialize};

use crate::scene::{Expectation, Expected, Measured, Seconds, When};

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

/// Looks at one expectation.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Judge {
    pub expectation: Expectation,
    /// The value that is taken off, once its time has come.
    pub base: Option<f64>,
    /// The value that counts so far, and when it was measured.
    seen: Option<(f64, Measured)>,
    has_failed: bool,
    has_held: bool,
}

impl Judge {
    pub fn new(expectation: Expectation) -> Self {
        Self { expectation, base: None, seen: None, has_failed: false, has_held: false }
    }

    /// The time from which on values count from a base, if they do.
    pub fn since(&self) -> Option<f64> {
        self.expectation.probe.since().map(Seconds::get)
    }

    /// Whether it looks at the step that ends at `time`, give or take `slack`; the last one, if `is_last`.
    pub fn looks_at(&self, time: f64, slack: f64, is_last: bool) -> bool {
        match &self.expectation.when {
            When::End => is_last,
            When::At(at) => (time - at.get()).abs() <= slack,
            When::Always => true,
            When::During(from, to) => time >= from.get() - slack && time <= to.get() + slack,
            When::Eventually { within, after } => {
                let is_due = after.is_none_or(|after| time >= after.get() - slack);
                !self.has_held && is_due && within.is_none_or(|within| time <= within.get() + slack)
            }
        }
    }

    /// Looks at a measured value.
    pub fn look(&mut self, time: f64, measured: Measured) {
        let excess = self.expectation.expect.excess(&measured);
        let is_eventually = matches!(self.expectation.when, When::Eventually { .. });
        let holds = excess <= 0.0;
        if is_eventually {
            // The nearest so far, and the first that holds; of words that differ, which are all as far, the last.
            let is_nearer = self.seen.as_ref().is_none_or(|(_, seen)| {
                excess < self.expectation.expect.excess(seen) || holds || excess == f64::INFINITY
            });
            if !self.has_held && is_nearer {
                self.seen = Some((time, measured));
            }
            self.has_held |= holds;
        } else {
            let is_worse =
                self.seen.as_ref().is_none_or(|(_, seen)| excess >= self.expectation.expect.excess(seen));
            if !self.has_failed && (is_worse || !holds) {
                self.seen = Some((time, measured));
            }
            self.has_failed |= !holds;
        }
    }

    /// Whether it has failed, whatever comes.
    pub fn is_broken(&self) -> bool {
        self.has_failed
    }

    pub fn verdict(&self) -> Verdict {
        let Expectation { when, probe, expect, .. } = &self.expectation;
        let is_report = *expect == Expected::Reported;
        let passed = match when {
            When::Eventually { .. } => self.has_held,
            _ => self.seen.is_some() && !self.has_failed,
        };
        Verdict {
            title: self.expectation.title(),
            probe: probe.to_string(),
            when: when.to_string(),
            expected: expect.to_string(),
            unit: probe.unit().to_string(),
            got: self.seen.as_ref().map(|(_, measured)| measured.clone()),
            time: self.seen.as_ref().map(|&(time, _)| time),
            passed: passed || is_report,
            is_report,
        }
    }
}
