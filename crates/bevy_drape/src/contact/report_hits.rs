//! Reports the hits of balls.

use bevy::prelude::*;
use drape_solver::Other;

use crate::body::activity::Activity;
use crate::clock::DrapeClock;
use crate::contact::hit::{BallHit, HitTarget, Touching};
use crate::environment::solver_environment::SolverEnvironment;
use crate::step::islands::Islands;

/// Sends a message for each ball that begins to touch something in this step.
pub(crate) fn report_hits(
    islands: Res<Islands>,
    solver: Res<SolverEnvironment>,
    activities: Query<&Activity>,
    clock: Res<DrapeClock>,
    mut touching: ResMut<Touching>,
    mut hits: MessageWriter<BallHit>,
) {
    let elapsed = clock.elapsed();
    touching
        .begin_step(elapsed, |ball| activities.get(ball).is_ok_and(|activity| *activity != Activity::Active));
    for island in islands.live() {
        for touch in &island.solver().touches {
            let projectile = island.balls[touch.ball];
            let (target, kind) = match touch.other {
                Other::Body(i) => (island.bodies[i], HitTarget::Body),
                Other::Ball(i) => (island.balls[i], HitTarget::Projectile),
                Other::Obstacle(i) => (solver.obstacles.entity(i), HitTarget::Obstacle),
            };
            if touching.note(elapsed, projectile, target) {
                hits.write(BallHit {
                    projectile,
                    target,
                    kind,
                    time: elapsed + f64::from(touch.time),
                    ball_position: touch.ball_position,
                    ball_velocity: touch.ball_velocity,
                    point: touch.point,
                    normal: touch.normal,
                    impulse: touch.impulse,
                });
            }
        }
    }
}
