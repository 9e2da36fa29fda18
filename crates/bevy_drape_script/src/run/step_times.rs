//! Measures step times, apart from the scene; they are only reported.

use core::time::Duration;

use bevy::prelude::*;
use bevy_drape::schedule::StepTimes;

use super::runner::SceneRunner;
use crate::play::Verdict;
use crate::scene::{Measured, Probe, SceneScript, Seconds};

/// The number of steps that are timed.
const TIMED: u32 = 60;

/// Fills in the values of `StepTimeRatio` probes.
pub(crate) fn measure(script: &SceneScript, verdicts: &mut [Verdict]) {
    for (expectation, verdict) in script.expectations.iter().zip(verdicts) {
        let Probe::StepTimeRatio { of, against } = &expectation.probe else { continue };
        if let (Some(one), Some(other)) = (median_step(script, of), median_step(script, against)) {
            let ratio = one.as_secs_f64() / other.as_secs_f64().max(1e-9);
            (verdict.got, verdict.time) = (Some(Measured::Number(ratio)), Some(0.0));
            verdict.passed = true;
        }
    }
}

/// The median time of a step of the scene with `name` as its only body.
fn median_step(script: &SceneScript, name: &str) -> Option<Duration> {
    let body = script.bodies.get(name)?.clone();
    let mut alone = SceneScript { timeline: Vec::new(), expectations: Vec::new(), ..script.clone() };
    alone.bodies.clear();
    alone.bodies.insert(name.to_string(), body);
    alone.settings.duration = Seconds::new(f64::from(TIMED) * script.settings.dt.get()).ok()?;
    let mut times = Vec::new();
    SceneRunner::headless(alone).run_with(|world, _| times.push(world.resource::<StepTimes>().step));
    times.sort_unstable();
    times.get(times.len() / 2).copied()
}
