//! The wind that blows everywhere.

use bevy::prelude::*;
use drape_solver::Turbulence;

/// The wind that blows everywhere. It pushes faces of cloths and links of ropes ([`drape_solver::Wind`]). Use a
/// [`WindZone`] for local wind.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wind {
    /// Velocity of the air in m/s; zero for no wind.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub velocity: Vec3,
    /// Density of the air in kg/m^3.
    pub air_density: f32,
    /// Drag coefficient of a plate at right angles to the wind; 1.2 for a flat one.
    pub drag_coefficient: f32,
    /// Coefficient of lift, a force at right angles to the wind; 0 by default. With about 1, flags flutter more.
    pub lift_coefficient: f32,
    /// Changes of the wind in space and time.
    pub gusts: Gusts,
    /// Part of the wind that an obstacle upwind, within 10 m, keeps off: from 0, the default, to 1.
    pub shelter: f32,
}

/// Gusts, the same in every run. Bodies do not fall asleep in them.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gusts {
    /// Root mean square of their speed in m/s; 0, the default, is a steady wind.
    pub speed: f32,
    /// Size of the largest gusts in metres; 4 by default.
    pub length: f32,
    /// Seed of the random gusts.
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
