//! The simulation's clock: pause, single steps, slow motion.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::clock::DrapeClock;
//!
//! let mut clock = DrapeClock::default();
//! clock.time_scale = 0.25; // slow motion
//! clock.paused = true;
//! clock.step_once(); // one step, then it is paused again
//! assert_eq!(clock.steps(), 0, "the plugin counts the steps that it takes");
//! ```

use bevy::prelude::*;

/// The simulation's time, and its control.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeClock {
    /// True to pause the simulation.
    pub paused: bool,
    /// Speed of simulated time: 1 is real time, 0.25 slow motion. Zero, negative and non-finite values stop it.
    pub time_scale: f32,
    pending_steps: u32,
    delta: f32,
    elapsed: f64,
    steps: u64,
}

impl Default for DrapeClock {
    fn default() -> Self {
        Self { paused: false, time_scale: 1.0, pending_steps: 0, delta: 0.0, elapsed: 0.0, steps: 0 }
    }
}

impl DrapeClock {
    /// Requests one step of a paused simulation.
    pub fn step_once(&mut self) {
        self.pending_steps += 1;
    }

    /// Length of the current or last step in seconds.
    pub fn delta(&self) -> f32 {
        self.delta
    }

    /// Simulated time in seconds, up to the end of the last step.
    pub fn elapsed(&self) -> f64 {
        self.elapsed
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Starts a step for `timestep` seconds of the schedule; false if no step is due.
    pub(crate) fn begin_step(&mut self, timestep: f32) -> bool {
        let delta = timestep * self.time_scale;
        if !(delta > 0.0 && delta.is_finite()) {
            return false;
        }
        if self.paused {
            if self.pending_steps == 0 {
                return false;
            }
            self.pending_steps -= 1;
        }
        self.delta = delta;
        true
    }

    pub(crate) fn end_step(&mut self) {
        self.elapsed += f64::from(self.delta);
        self.steps += 1;
    }
}
