//! Moves dynamic obstacles through the coming step.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use drape_solver::Placement;

use crate::clock::DrapeClock;
use crate::environment::dynamic_obstacle::{DynamicObstacle, PlannedPlacement};
use crate::environment::gravity::DrapeGravity;
use crate::environment::obstacle::Obstacle;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wake_regions::WakeRegions;
use crate::refusal::Refusals;

/// Moves dynamic obstacles freely through the coming step, or to where another engine has moved them.
pub(crate) fn fly_dynamic_obstacles(
    obstacles: Query<(Entity, &DynamicObstacle, Option<&PlannedPlacement>), With<Obstacle>>,
    clock: Res<DrapeClock>,
    gravity: Res<DrapeGravity>,
    mut solver: ResMut<SolverEnvironment>,
    mut wake_regions: ResMut<WakeRegions>,
    mut refusals: ResMut<Refusals>,
    mut refused: Local<EntityHashSet>,
) {
    let gravity = gravity.or_last(solver.environment.gravity);
    let SolverEnvironment { environment, obstacles: known, .. } = &mut *solver;
    for (entity, dynamic, planned) in &obstacles {
        let body = dynamic.body();
        match &body {
            Ok(_) if refused.remove(&entity) => refusals.forget(entity),
            Err(error) if refused.insert(entity) => refusals.entity(entity, "DynamicObstacle", error.clone()),
            _ => {}
        }
        let Some(slot) = known.slot(entity) else { continue };
        let obstacle = &mut environment.obstacles[slot];
        obstacle.set_rigid_body(body.ok());
        match planned {
            Some(&PlannedPlacement { translation, rotation }) => {
                let there = Placement { translation, rotation };
                obstacle.fly_to(unless_rounded(obstacle.placement(), there), clock.delta());
            }
            None => obstacle.fly(gravity * dynamic.gravity_scale, clock.delta()),
        }
        if obstacle.is_moving() {
            wake_regions.push(obstacle);
        }
    }
}

/// `there`, or `here` if the two differ only by the rounding of a rotation that has been in a matrix. Such a motion would
/// keep awake what lies on the obstacle.
fn unless_rounded(here: Placement, there: Placement) -> Placement {
    let turn = (here.rotation - there.rotation).length_squared();
    if here.translation == there.translation && turn < ROUNDED_TURN { here } else { there }
}

/// Square of the difference of two unit quaternions that are the same but for rounding.
const ROUNDED_TURN: f32 = 1e-12;
