//! Sends bodies that lie on cloth to sleep, and wakes those that cloth moves.
//!
//! Avian sends a body to sleep that is slow at the end of its own step. One that lies on cloth is falling then, since
//! cloth takes its step later.

use avian3d::dynamics::solver::islands::{BodyIslandNode, SleepBody, WakeBody};
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape_bridge::{BodyObstacle, EngineBody, Load, ObstacleOf, WakeRequest};

/// On the obstacle of a body: seconds for which the body has been slow enough for sleep.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct StillFor(f32);

/// Counts the time for which bodies have been slow, after cloth has pushed them.
pub(crate) fn note_still(
    mut obstacles: Query<(&ObstacleOf, &EngineBody, &mut StillFor)>,
    bodies: Query<(&LinearVelocity, &AngularVelocity, Option<&SleepThreshold>, Has<SleepingDisabled>)>,
    time: Res<Time>,
) {
    for (of, body, mut still) in &mut obstacles {
        let Ok((velocity, spin, threshold, is_kept_awake)) = bodies.get(of.0) else { continue };
        let threshold = threshold.copied().unwrap_or_default();
        let is_slow = velocity.length() < threshold.linear && spin.length() < threshold.angular;
        let is_still = is_slow && !is_kept_awake && !body.is_asleep;
        still.0 = if is_still { still.0 + time.delta_secs() } else { 0.0 };
    }
}

/// Sends islands of bodies to sleep that lie on cloth and have been still for long enough. Runs in Avian's step: what cloth
/// has handed back after it would wake a body that sleeps.
pub(crate) fn fall_asleep(
    obstacles: Query<(&ObstacleOf, &Load, &StillFor)>,
    bodies: Query<(&BodyIslandNode, &SleepTimer, Option<&BodyObstacle>), Without<Sleeping>>,
    mut velocities: Query<(&mut LinearVelocity, &mut AngularVelocity)>,
    mut commands: Commands,
    time_to_sleep: Res<TimeToSleep>,
) {
    for (of, load, still) in &obstacles {
        if !load.is_carried() || still.0 < time_to_sleep.0 {
            continue;
        }
        let Ok((island, ..)) = bodies.get(of.0) else { continue };
        let is_still = |timer: &SleepTimer, obstacle: Option<&BodyObstacle>| {
            let still = obstacle.and_then(|obstacle| obstacles.get(obstacle.entity()).ok());
            timer.0.max(still.map_or(0.0, |(.., still)| still.0)) >= time_to_sleep.0
        };
        let mut others = bodies.iter().filter(|(other, ..)| other.island_id() == island.island_id());
        if others.all(|(_, timer, obstacle)| is_still(timer, obstacle)) {
            commands.queue(SleepBody(of.0));
            if let Ok((mut velocity, mut spin)) = velocities.get_mut(of.0) {
                // It has begun to fall in this step.
                (velocity.0, spin.0) = (Vec3::ZERO, Vec3::ZERO);
            }
        }
    }
}

/// Wakes a body for cloth.
pub(crate) fn wake(request: On<WakeRequest>, mut commands: Commands) {
    commands.queue(WakeBody(request.entity));
}
