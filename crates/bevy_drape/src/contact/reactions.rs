//! Reactions of obstacles to the contacts of a step.

use bevy::prelude::*;

use crate::environment::dynamic_obstacle::{DynamicObstacle, ObstacleReaction};
use crate::environment::obstacle::Obstacle;
use crate::environment::solver_environment::SolverEnvironment;
use crate::step::islands::Islands;

/// Gives obstacles their reactions, and dynamic ones their new transforms and velocities.
pub(crate) fn give_reactions(
    mut reactions: Query<&mut ObstacleReaction>,
    mut dynamics: Query<(Entity, &mut DynamicObstacle, &mut Transform), With<Obstacle>>,
    islands: Res<Islands>,
    mut solver: ResMut<SolverEnvironment>,
) {
    let SolverEnvironment { environment, obstacles: known, .. } = &mut *solver;
    for mut reaction in &mut reactions {
        reaction.set_if_neq(ObstacleReaction::default());
    }
    for island in islands.live() {
        for reaction in &island.solver().reactions {
            if let Ok(mut sum) = reactions.get_mut(known.entity(reaction.obstacle)) {
                sum.impulse += reaction.impulse;
                sum.angular_impulse += reaction.angular_impulse;
            }
        }
        for moved in &island.solver().moved {
            environment.obstacles[moved.obstacle].land(moved);
            if let Ok(mut sum) = reactions.get_mut(known.entity(moved.obstacle)) {
                sum.is_near = true;
            }
        }
    }
    for (entity, mut dynamic, mut transform) in &mut dynamics {
        let Some(obstacle) = known.slot(entity).map(|slot| &environment.obstacles[slot]) else { continue };
        let (Some(body), place) = (obstacle.rigid_body(), obstacle.placement()) else { continue };
        let there = transform.with_translation(place.translation).with_rotation(place.rotation);
        // An obstacle that does not move keeps the exact transform that it was given.
        if obstacle.is_moving() {
            transform.set_if_neq(there);
        }
        dynamic.set_if_neq(DynamicObstacle {
            velocity: body.velocity,
            angular_velocity: body.angular_velocity,
            ..*dynamic
        });
    }
}
