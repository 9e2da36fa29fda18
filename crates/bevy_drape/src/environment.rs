//! Gravity and wind.

use bevy::prelude::*;
use drape_solver::Environment;
use drape_solver::constants::MAX_MAGNITUDE;

use crate::clock::DrapeClock;
use crate::obstacle::KnownObstacles;
use crate::refusal::Refusals;

/// Acceleration of gravity in m/s^2.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeGravity(#[cfg_attr(feature = "serde", serde(with = "crate::snapshot::vector"))] pub Vec3);

impl Default for DrapeGravity {
    fn default() -> Self {
        Self(Vec3::new(0.0, -9.81, 0.0))
    }
}

/// The wind, the same everywhere. It pushes on the faces of cloths and the links of ropes.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wind {
    /// Velocity of the air in m/s; zero is no wind.
    #[cfg_attr(feature = "serde", serde(with = "crate::snapshot::vector"))]
    pub velocity: Vec3,
    /// Density of the air in kg/m^3.
    pub air_density: f32,
    /// Drag coefficient of a plate square to the wind; 1.2 for a flat one.
    pub drag_coefficient: f32,
}

impl Default for Wind {
    fn default() -> Self {
        drape_solver::Wind::default().into()
    }
}

impl From<drape_solver::Wind> for Wind {
    fn from(wind: drape_solver::Wind) -> Self {
        let drape_solver::Wind { velocity, air_density, drag_coefficient } = wind;
        Self { velocity, air_density, drag_coefficient }
    }
}

impl From<Wind> for drape_solver::Wind {
    fn from(wind: Wind) -> Self {
        let Wind { velocity, air_density, drag_coefficient } = wind;
        Self { velocity, air_density, drag_coefficient }
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

/// Brings time, gravity and wind into the solver. What is not finite is refused, and the last good value kept.
pub(crate) fn read_environment(
    clock: Res<DrapeClock>,
    gravity: Res<DrapeGravity>,
    wind: Res<Wind>,
    mut solver: ResMut<SolverEnvironment>,
    mut refusals: ResMut<Refusals>,
) {
    let SolverEnvironment { environment, changed, .. } = &mut *solver;
    environment.dt = clock.delta();
    *changed = false;
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
            *changed |= environment.wind != new_wind;
            environment.wind = new_wind;
            refusals.forget_resource("Wind");
        }
        Err(_) => refusals.resource("Wind", "it must be finite and below 1e6; the last good value stays"),
    }
}
