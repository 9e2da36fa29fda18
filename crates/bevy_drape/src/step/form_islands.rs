//! Groups the active bodies and balls into islands.

use bevy::prelude::*;
use drape_solver::constants::CONTACT_MARGIN;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::grouping::Member;
use drape_solver::world::kind::Kind;

use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::change_detection::collect_rows;
use crate::environment::dynamic_obstacle::DynamicObstacle;
use crate::environment::obstacle::Obstacle;
use crate::environment::solver_environment::SolverEnvironment;
use crate::refusal::Refusals;
use crate::step::islands::Islands;

/// Lowest order of dynamic obstacles, above those of all bodies and balls.
const LATEST: u64 = 1 << 63;

/// Groups all active bodies and balls into the islands of this step.
pub(crate) fn form_islands(
    mut bodies: Query<(Entity, &mut Activity, &Particles, &Sticks, &mut BodyState)>,
    balls: Query<(Entity, &Activity, &ProjectileState, &ProjectileRecord), Without<Particles>>,
    dynamic_obstacles: Query<Entity, (With<DynamicObstacle>, With<Obstacle>)>,
    solver: Res<SolverEnvironment>,
    mut islands: ResMut<Islands>,
    mut refusals: ResMut<Refusals>,
    mut active: Local<Vec<Entity>>,
) {
    let (dt, gravity) = (solver.environment.dt, solver.environment.gravity.length());
    islands.clear();
    for (entities, activities, ..) in bodies.contiguous_iter().into_iter().flatten() {
        collect_rows(entities, |rows| Activity::is_any_active(&activities[rows]), &mut active);
    }
    for entity in active.drain(..) {
        let Ok((_, mut activity, particles, sticks, mut state)) = bodies.get_mut(entity) else { continue };
        if state.refused {
            continue;
        }
        if !sticks.fit(particles) {
            let (count, wanted) = (particles.len(), sticks.particle_count());
            let reason = format!("it has {count} particles, but its Sticks join {wanted}");
            refusals.entity(entity, "Particles", reason);
            state.refused = true;
            *activity = Activity::Culled;
            continue;
        }
        let bounds = state.bounds_within_step(dt, gravity);
        let kind = Kind::of_body(&state.settings);
        islands.grouping.push(Member { order: state.order, key: entity, kind, bounds });
    }
    for (entities, activities, ..) in balls.contiguous_iter().into_iter().flatten() {
        collect_rows(entities, |rows| Activity::is_any_active(&activities[rows]), &mut active);
    }
    for entity in active.drain(..) {
        let Ok((_, _, state, record)) = balls.get(entity) else { continue };
        if !record.refused {
            let bounds = state.bounds_within_step(dt, gravity);
            islands.grouping.push(Member { order: record.order, key: entity, kind: Kind::Ball, bounds });
        }
    }
    for (place, entity) in dynamic_obstacles.iter().enumerate() {
        if let Some(slot) = solver.obstacles.slot(entity) {
            let bounds =
                Bounds::from(solver.environment.obstacles[slot].swept_bounds()).grown(CONTACT_MARGIN);
            let order = LATEST + place as u64;
            islands.grouping.push(Member { order, key: entity, kind: Kind::Obstacle, bounds });
        }
    }
    islands.form();
}
