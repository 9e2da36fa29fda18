//! What holds for the whole scene.

use bevy::prelude::*;
use bevy_drape::prelude as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Fraction, NonNegative, Number, Positive, Seconds, Solver, StepLength, Vector};

/// What holds for the whole scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// How long the scene runs, in seconds; 5 by default.
    pub duration: Seconds,
    /// The length of a step in seconds; a 60th by default.
    pub dt: StepLength,
    /// Acceleration of gravity in m/s^2; (0, -9.81, 0) by default.
    pub gravity: Vector,
    /// The wind; none by default.
    pub wind: Wind,
    /// How bodies are solved that do not say it themselves.
    pub solver: Solver,
    /// Whether bodies at rest fall asleep; true by default.
    pub sleeping: bool,
    /// Where the scatter of copies starts from; 0 by default. The same seed scatters the same way everywhere.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            duration: Seconds::known(5.0),
            dt: StepLength::known(1.0 / 60.0),
            gravity: Vector::known(drape::DrapeGravity::default().0),
            wind: Wind::default(),
            solver: Solver::default(),
            sleeping: true,
            seed: 0,
        }
    }
}

/// The wind that blows everywhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Wind {
    /// Velocity of the air in m/s; (0, 0, 0), no wind, by default.
    pub velocity: Vector,
    /// Density of the air in kg/m^3; 1.2 by default.
    pub air_density: NonNegative,
    /// Drag coefficient of a plate square to the wind; 1.2 by default.
    pub drag_coefficient: Number,
    /// Lift coefficient, of a force at right angles to the wind; 0 by default. With some 1, flags flutter more.
    pub lift_coefficient: Number,
    /// How it differs from place to place and from moment to moment; not at all by default.
    pub gusts: Gusts,
    /// The part of it that is spared what has an obstacle between itself and the wind, from 0 to 1; 0 by default.
    pub shelter: Fraction,
}

/// Gusts, the same in every run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Gusts {
    /// Root mean square of their speed in m/s; 0, a steady wind, by default.
    pub speed: NonNegative,
    /// Size of the greatest in metres; 4 by default.
    pub length: Positive,
    /// Another seed is another day; 0 by default.
    pub seed: u32,
}

impl Default for Gusts {
    fn default() -> Self {
        let drape::Gusts { speed, length, seed } = drape::Gusts::default();
        Self { speed: NonNegative::known(speed), length: Positive::known(length), seed }
    }
}

impl From<Gusts> for drape::Gusts {
    fn from(gusts: Gusts) -> Self {
        Self { speed: gusts.speed.get(), length: gusts.length.get(), seed: gusts.seed }
    }
}

impl Default for Wind {
    fn default() -> Self {
        let drape::Wind { velocity, air_density, drag_coefficient, lift_coefficient, shelter, .. } =
            drape::Wind::default();
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

impl From<&Wind> for drape::Wind {
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

impl From<&Settings> for drape::DrapeGravity {
    fn from(settings: &Settings) -> Self {
        Self(settings.gravity.get())
    }
}

impl From<&Settings> for Time<Fixed> {
    fn from(settings: &Settings) -> Self {
        Self::from_seconds(settings.dt.get())
    }
}
