//! Gravity, wind, time and obstacles: the same for all islands in one step.

use glam::Vec3;

use crate::error::StepError;
use crate::motion::wind::{Wind, WindZone};
use crate::state::obstacles::Obstacles;

/// Inputs that all islands share in one step.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Length of the step in seconds.
    pub dt: f32,
    /// Acceleration of gravity in m/s^2.
    pub gravity: Vec3,
    /// The wind that blows everywhere.
    pub wind: Wind,
    /// Places with a wind of their own.
    pub wind_zones: Vec<WindZone>,
    /// Time in seconds since the start, which drives gusts.
    pub time: f64,
    /// The obstacles.
    pub obstacles: Obstacles,
}

impl Environment {
    /// Checks everything but the obstacles, which are checked when they are made.
    ///
    /// # Errors
    /// [`StepError::BadTimestep`], [`StepError::BadEnvironment`].
    pub fn validate(&self) -> Result<(), StepError> {
        if !(self.dt > 0.0 && self.dt.is_finite()) {
            return Err(StepError::BadTimestep(self.dt));
        }
        for (is_finite, name) in [(self.gravity.is_finite(), "gravity"), (self.time.is_finite(), "time")] {
            if !is_finite {
                return Err(StepError::BadEnvironment(name));
            }
        }
        self.wind.validate()?;
        self.wind_zones.iter().try_for_each(WindZone::validate)
    }

    /// Greatest way in metres of something of this speed (m/s) that flies freely through the step.
    pub(crate) fn greatest_way(&self, speed: f32) -> f32 {
        (speed + self.gravity.length() * self.dt) * self.dt
    }
}

impl Default for Environment {
    fn default() -> Self {
        Self {
            dt: 1.0 / 60.0,
            gravity: Vec3::new(0.0, -9.81, 0.0),
            wind: Wind::default(),
            wind_zones: Vec::new(),
            time: 0.0,
            obstacles: Obstacles::new(),
        }
    }
}
