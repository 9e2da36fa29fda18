//! Settings of the whole scene.

use bevy::prelude::*;
use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Fraction, NonNegative, Number, Positive, Seconds, Solver, StepLength, Surface, Vector};

/// Settings of the whole scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Duration of the scene in seconds; 5 by default.
    pub duration: Seconds,
    /// Length of a step in seconds; 1/60 by default.
    pub dt: StepLength,
    /// Acceleration of gravity in m/s^2; (0, -9.81, 0) by default.
    pub gravity: Vector,
    /// The wind; none by default.
    pub wind: Wind,
    /// Solver settings of bodies that do not give their own.
    pub solver: Solver,
    /// The surface of bodies that do not give their own.
    pub surface: Surface,
    /// True to let bodies at rest fall asleep; true by default.
    pub sleeping: bool,
    /// Seed of the scatter of copies; 0 by default. Equal seeds scatter equally on every machine.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            duration: Seconds::known(5.0),
            dt: StepLength::known(1.0 / 60.0),
            gravity: Vector::known(drape::environment::DrapeGravity::default().0),
            wind: Wind::default(),
            solver: Solver::default(),
            surface: Surface::default(),
            sleeping: true,
            seed: 0,
        }
    }
}

/// The global wind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Wind {
    /// Velocity of the air in m/s; (0, 0, 0), no wind, by default.
    pub velocity: Vector,
    /// Density of the air in kg/m^3; 1.2 by default.
    pub air_density: NonNegative,
    /// Drag coefficient of a plate square to the wind; 1.2 by default.
    pub drag_coefficient: Number,
    /// Lift coefficient, for the force at right angles to the wind; 0 by default. Values near 1 make flags flutter
    /// more.
    pub lift_coefficient: Number,
    /// Gusts, which vary in space and time; none by default.
    pub gusts: Gusts,
    /// Fraction of the wind that an obstacle upwind keeps off, from 0 to 1; 0 by default.
    pub shelter: Fraction,
}

/// Gusts, equal in every run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Gusts {
    /// Root mean square of their speed in m/s; 0, a steady wind, by default.
    pub speed: NonNegative,
    /// Size of the largest gusts in metres; 4 by default.
    pub length: Positive,
    /// Seed; 0 by default. Another seed gives other gusts.
    pub seed: u32,
}

impl Default for Gusts {
    fn default() -> Self {
        let drape::environment::Gusts { speed, length, seed } = drape::environment::Gusts::default();
        Self { speed: NonNegative::known(speed), length: Positive::known(length), seed }
    }
}

impl From<Gusts> for drape::environment::Gusts {
    fn from(gusts: Gusts) -> Self {
        Self { speed: gusts.speed.get(), length: gusts.length.get(), seed: gusts.seed }
    }
}

impl Default for Wind {
    fn default() -> Self {
        let drape::environment::Wind {
            velocity,
            air_density,
            drag_coefficient,
            lift_coefficient,
            shelter,
            ..
        } = drape::environment::Wind::default();
        Self {
            velocity: Vector::known(velocity),
            air_density: NonNegative::known(air_density),
            drag_coefficient: Number::known(drag_coefficient),
            lift_coefficient: Number::known(lift_coefficient),
            gusts: Gusts::default(),
            shelter: Fraction::known(shelter),
        }
    }
}

impl From<&Wind> for drape::environment::Wind {
    fn from(wind: &Wind) -> Self {
        Self {
            velocity: wind.velocity.get(),
            air_density: wind.air_density.get(),
            drag_coefficient: wind.drag_coefficient.get(),
            lift_coefficient: wind.lift_coefficient.get(),
            gusts: wind.gusts.into(),
            shelter: wind.shelter.get(),
        }
    }
}

impl From<&Settings> for drape::environment::DrapeGravity {
    fn from(settings: &Settings) -> Self {
        Self(settings.gravity.get())
    }
}

impl From<&Settings> for Time<Fixed> {
    fn from(settings: &Settings) -> Self {
        Self::from_seconds(settings.dt.get())
    }
}
