//! Sends bodies that lie on cloth to sleep, and wakes those that cloth moves.
//!
//! Avian sends a body to sleep that is slow at the end of its own step. One that lies on cloth is falling then, since
//! cloth takes its step later.

use avian3d::dynamics::solver::islands::{BodyIslandNode, SleepBody, WakeBody};
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape_bridge::{BodyObstacle, EngineBody, Load, ObstacleOf, WakeRequest};

/// Sends islands of bodies to sleep that lie on cloth and have been still for long enough. Runs in Avian's step: what cloth
/// has handed back after it would wake a body that sleeps.
pub(crate) fn fall_asleep(
    obstacles: Query<(&ObstacleOf, &Load, &EngineBody)>,
    bodies: Query<(&BodyIslandNode, &SleepTimer, Option<&BodyObstacle>), Without<Sleeping>>,
    mut motions: Query<(&mut Position, &mut Rotation, &mut LinearVelocity, &mut AngularVelocity)>,
    mut commands: Commands,
    time_to_sleep: Res<TimeToSleep>,
) {
    for (of, load, body) in &obstacles {
        if !load.is_carried() || load.still_for < time_to_sleep.0 {
            continue;
        }
        let Ok((island, ..)) = bodies.get(of.0) else { continue };
        let is_still = |timer: &SleepTimer, obstacle: Option<&BodyObstacle>| {
            let load = obstacle.and_then(|obstacle| obstacles.get(obstacle.entity()).ok());
            timer.0.max(load.map_or(0.0, |(_, load, _)| load.still_for)) >= time_to_sleep.0
        };
        let mut others = bodies.iter().filter(|(other, ..)| other.island_id() == island.island_id());
        if others.all(|(_, timer, obstacle)| is_still(timer, obstacle)) {
            commands.queue(SleepBody(of.0));
            if let Ok((mut position, mut rotation, mut velocity, mut spin)) = motions.get_mut(of.0) {
                // It has begun to fall in this step.
                (position.0, rotation.0) = (body.left.translation, body.left.rotation);
                (velocity.0, spin.0) = (Vec3::ZERO, Vec3::ZERO);
            }
        }
    }
}

/// Wakes a body for cloth.
pub(crate) fn wake(request: On<WakeRequest>, mut commands: Commands) {
    commands.queue(WakeBody(request.entity));
}
