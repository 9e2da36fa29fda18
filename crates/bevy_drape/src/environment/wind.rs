//! The wind that blows everywhere.

use bevy::prelude::*;
use drape_solver::Turbulence;

/// The wind that blows everywhere. It pushes on the faces of cloths and the links of ropes, as [`drape_solver::Wind`] says;
/// places with a wind of their own have a [`WindZone`].
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wind {
    /// Velocity of the air in m/s; zero is no wind.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub velocity: Vec3,
    /// Density of the air in kg/m^3.
    pub air_density: f32,
    /// Drag coefficient of a plate square to the wind; 1.2 for a flat one.
    pub drag_coefficient: f32,
    /// Lift coefficient, of a force at right angles to the wind; 0 by default. With some 1, flags flutter more.
    pub lift_coefficient: f32,
    /// How the wind differs from place to place and from moment to moment.
    pub gusts: Gusts,
    /// The part of the wind that is spared what has an obstacle between itself and the wind, within 10 m: from 0, the
    /// default, to 1.
    pub shelter: f32,
}

/// Gusts, the same in every run. While they blow, nothing falls asleep.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gusts {
    /// Root mean square of their speed in m/s; 0, the default, is a steady wind.
    pub speed: f32,
    /// Size of the greatest in metres; 4 by default.
    pub length: f32,
    /// Another seed is another day.
    pub seed: u32,
}

impl Default for Gusts {
    fn default() -> Self {
        Turbulence::default().into()
    }
}

impl From<Turbulence> for Gusts {
    fn from(Turbulence { speed, length, seed }: Turbulence) -> Self {
        Self { speed, length, seed }
    }
}

impl From<Gusts> for Turbulence {
    fn from(Gusts { speed, length, seed }: Gusts) -> Self {
        Self { speed, length, seed }
    }
}

impl Wind {
    /// A wind of `velocity` (m/s) in ordinary air.
    pub fn new(velocity: Vec3) -> Self {
        Self { velocity, ..Self::default() }
    }
}

impl Default for Wind {
    fn default() -> Self {
        drape_solver::Wind::default().into()
    }
}

impl From<drape_solver::Wind> for Wind {
    fn from(wind: drape_solver::Wind) -> Self {
        let drape_solver::Wind {
            velocity,
            air_density,
            drag_coefficient,
            lift_coefficient,
            turbulence,
            shelter,
        } = wind;
        let gusts = turbulence.into();
        Self { velocity, air_density, drag_coefficient, lift_coefficient, gusts, shelter }
    }
}

impl From<Wind> for drape_solver::Wind {
    fn from(wind: Wind) -> Self {
        let Wind { velocity, air_density, drag_coefficient, lift_coefficient, gusts, shelter } = wind;
        let turbulence = gusts.into();
        Self { velocity, air_density, drag_coefficient, lift_coefficient, turbulence, shelter }
    }
}
