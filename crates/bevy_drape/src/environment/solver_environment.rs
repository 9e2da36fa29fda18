//! The solver's environment, and the time, gravity and wind in it.

use bevy::prelude::*;
use drape_solver::Environment;

use crate::clock::DrapeClock;
use crate::environment::gravity::DrapeGravity;
use crate::environment::known_obstacles::KnownObstacles;
use crate::environment::wind::Wind;
use crate::environment::wind_zone::{WindZone, read_zones};
use crate::refusal::Refusals;

/// The solver's view of the world in this step, and the entities behind its obstacles.
#[derive(Resource, Default)]
pub(crate) struct SolverEnvironment {
    pub environment: Environment,
    /// The entities behind the obstacles.
    pub obstacles: KnownObstacles,
    /// True if gravity, wind or a wind zone changed since the last step, which wakes everything.
    pub changed: bool,
    /// True if gravity or wind did.
    pub air_changed: bool,
}

/// Brings time, gravity, wind and wind zones into the solver. Refuses invalid values and keeps the last good ones.
pub(crate) fn read_environment(
    clock: Res<DrapeClock>,
    gravity: Res<DrapeGravity>,
    wind: Res<Wind>,
    zones: Query<(Entity, &WindZone, &GlobalTransform)>,
    mut solver: ResMut<SolverEnvironment>,
    mut refusals: ResMut<Refusals>,
    mut found_zones: Local<Vec<drape_solver::WindZone>>,
) {
    let SolverEnvironment { environment, changed, air_changed, .. } = &mut *solver;
    environment.dt = clock.delta();
    environment.time = clock.elapsed();
    *air_changed = false;
    if gravity.is_usable() {
        *air_changed |= environment.gravity != gravity.0;
        environment.gravity = gravity.0;
        refusals.forget_resource("DrapeGravity");
    } else {
        refusals.resource("DrapeGravity", "it must be finite and below 1e6; the last good value stays");
    }
    let new_wind = drape_solver::Wind::from(*wind);
    match new_wind.validate() {
        Ok(()) => {
            *air_changed |= environment.wind != new_wind || new_wind.turbulence.speed > 0.0;
            environment.wind = new_wind;
            refusals.forget_resource("Wind");
        }
        Err(_) => refusals.resource(
            "Wind",
            "it must be finite and below 1e6, gusts must have a length above zero and no negative speed, and shelter \
             must be from 0 to 1; the last good value stays",
        ),
    }
    *changed =
        read_zones(&zones, &mut environment.wind_zones, &mut found_zones, &mut refusals) || *air_changed;
}
