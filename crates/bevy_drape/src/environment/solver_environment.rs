//! Gravity and wind.

use bevy::prelude::*;
use drape_solver::constants::MAX_MAGNITUDE;
use drape_solver::{Environment, Turbulence};

use crate::clock::DrapeClock;
use crate::environment::obstacle::KnownObstacles;
use crate::environment::wind_zone::{WindZone, read_zones};
use crate::refusal::Refusals;

/// Acceleration of gravity in m/s^2.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeGravity(#[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))] pub Vec3);

impl Default for DrapeGravity {
    fn default() -> Self {
        Self(Vec3::new(0.0, -9.81, 0.0))
    }
}

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

/// What the solver sees of the world in this step, with the entities behind the obstacles.
#[derive(Resource, Default)]
pub(crate) struct SolverEnvironment {
    pub environment: Environment,
    /// The entities behind the obstacles.
    pub obstacles: KnownObstacles,
    /// Whether gravity or wind changed since the last step, which wakes everything.
    pub changed: bool,
}

impl DrapeGravity {
    /// Whether the solver can compute with it: finite and below 10^6 m/s^2.
    pub(crate) fn is_usable(&self) -> bool {
        // False for NaN.
        self.0.abs().cmple(Vec3::splat(MAX_MAGNITUDE)).all()
    }
}

/// Brings time, gravity, wind and its zones into the solver. What is not finite is refused, and the last good value kept.
pub(crate) fn read_environment(
    clock: Res<DrapeClock>,
    gravity: Res<DrapeGravity>,
    wind: Res<Wind>,
    zones: Query<(Entity, &WindZone, &GlobalTransform)>,
    mut solver: ResMut<SolverEnvironment>,
    mut refusals: ResMut<Refusals>,
    mut found_zones: Local<Vec<drape_solver::WindZone>>,
) {
    let SolverEnvironment { environment, changed, .. } = &mut *solver;
    environment.dt = clock.delta();
    environment.time = clock.elapsed();
    *changed = read_zones(&zones, &mut environment.wind_zones, &mut found_zones, &mut refusals);
    if gravity.is_usable() {
        *changed |= environment.gravity != gravity.0;
        environment.gravity = gravity.0;
        refusals.forget_resource("DrapeGravity");
    } else {
        refusals.resource("DrapeGravity", "it must be finite and below 1e6; the last good value stays");
    }
    let new_wind = drape_solver::Wind::from(*wind);
    match new_wind.validate() {
        Ok(()) => {
            *changed |= environment.wind != new_wind || new_wind.turbulence.speed > 0.0;
            environment.wind = new_wind;
            refusals.forget_resource("Wind");
        }
        Err(_) => refusals.resource(
            "Wind",
            "it must be finite and below 1e6, gusts must have a length above zero and no negative speed, and shelter \
             must be from 0 to 1; the last good value stays",
        ),
    }
}
