//! Evaluates expectations step by step.

use serde::{Deserialize, Serialize};

use super::verdict::Verdict;
use crate::scene::{Expectation, Expected, Measured, Probe, Seconds, When};

/// Evaluates one expectation while its scene runs.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct ExpectationEvaluator {
    expectation: Expectation,
    /// The value that is subtracted, once its time has come.
    base: Option<f64>,
    /// The decisive value so far, and when it was measured.
    seen: Option<(f64, Measured)>,
    has_failed: bool,
    has_held: bool,
}

impl ExpectationEvaluator {
    pub fn new(expectation: Expectation) -> Self {
        Self { expectation, base: None, seen: None, has_failed: false, has_held: false }
    }

    /// Measures and evaluates the probe if the step that ends at `time` counts, give or take `slack`, all in seconds.
    pub fn step(
        &mut self,
        time: f64,
        slack: f64,
        is_last: bool,
        measure: impl FnOnce(&Probe) -> Option<Measured>,
    ) {
        let since = self.expectation.probe.since().map(Seconds::get);
        let base_is_due = self.base.is_none() && since.is_some_and(|since| time >= since - slack);
        // A value relative to a base is unknown before the base is.
        let has_base = since.is_none() || self.base.is_some() || base_is_due;
        let is_due = has_base && self.is_due(time, slack, is_last);
        if !is_due && !base_is_due {
            return;
        }
        let Some(mut measured) = measure(&self.expectation.probe) else { return };
        if let Measured::Number(number) = &mut measured {
            if base_is_due {
                self.base = Some(*number);
            }
            *number -= self.base.unwrap_or(0.0);
        }
        if is_due {
            self.add(time, measured);
        }
    }

    /// True if the step that ends at `time` counts, give or take `slack`. The last step is marked by `is_last`.
    fn is_due(&self, time: f64, slack: f64, is_last: bool) -> bool {
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

    /// Takes a measured value into account.
    fn add(&mut self, time: f64, measured: Measured) {
        let excess = self.expectation.expect.excess(&measured);
        let is_eventually = matches!(self.expectation.when, When::Eventually { .. });
        let holds = excess <= 0.0;
        if is_eventually {
            // Keeps the nearest value so far, and the first that holds; of words that differ, all equally far, the last.
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

    /// True if it has failed, whatever comes.
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
