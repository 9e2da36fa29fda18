//! Sends bodies that lie on cloth to sleep, and wakes those that cloth moves.
//!
//! Avian sends a body to sleep that is slow at the end of its own step. One that lies on cloth is falling then, since
//! cloth takes its step later.

use avian3d::dynamics::solver::islands::{BodyIslandNode, SleepBody, WakeBody};
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::environment::{DynamicObstacle, ObstacleReaction};
use bevy_drape::prelude::*;

use crate::marks::{BodyObstacle, Load, ObstacleOf};

/// Takes the mean of the loads on bodies that are awake, and wakes those that cloth pushes otherwise than it did when
/// they fell asleep.
pub(crate) fn note_loads(
    mut obstacles: Query<(&ObstacleOf, &DynamicObstacle, &ObstacleReaction, &mut Load)>,
    mut bodies: Query<(
        &mut LinearVelocity,
        &AngularVelocity,
        Option<&SleepThreshold>,
        Has<SleepingDisabled>,
        Has<Sleeping>,
    )>,
    mut commands: Commands,
    time: Res<Time>,
) {
    for (of, dynamic, reaction, mut load) in &mut obstacles {
        let Ok((mut velocity, spin, threshold, is_kept_awake, is_sleeping)) = bodies.get_mut(of.0) else {
            continue;
        };
        let push = reaction.impulse / dynamic.mass;
        let acceleration = push / time.delta_secs();
        if is_sleeping {
            if reaction.is_near && acceleration.distance(load.acceleration) > WAKING_CHANGE {
                commands.queue(WakeBody(of.0));
                velocity.0 += push;
                *load = Load::default();
            }
            continue;
        }
        load.acceleration = load.acceleration.lerp(acceleration, LOAD_PART);
        let threshold = threshold.copied().unwrap_or_default();
        let is_still = velocity.length() < threshold.linear && spin.length() < threshold.angular;
        load.still_for = if is_still && !is_kept_awake { load.still_for + time.delta_secs() } else { 0.0 };
    }
}

/// Sends islands of bodies to sleep that lie on cloth and have been still for long enough. Runs in Avian's step: what cloth
/// has handed back after it would wake a body that sleeps.
pub(crate) fn fall_asleep(
    obstacles: Query<(&ObstacleOf, &Load)>,
    bodies: Query<(&BodyIslandNode, &SleepTimer, Option<&BodyObstacle>), Without<Sleeping>>,
    mut velocities: Query<(&mut LinearVelocity, &mut AngularVelocity)>,
    mut commands: Commands,
    time_to_sleep: Res<TimeToSleep>,
) {
    for (of, load) in &obstacles {
        if !load.is_carried() || load.still_for < time_to_sleep.0 {
            continue;
        }
        let Ok((island, ..)) = bodies.get(of.0) else { continue };
        let is_still = |timer: &SleepTimer, obstacle: Option<&BodyObstacle>| {
            let load = obstacle.and_then(|obstacle| obstacles.get(obstacle.entity()).ok());
            timer.0.max(load.map_or(0.0, |(_, load)| load.still_for)) >= time_to_sleep.0
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

/// Wakes bodies that slept on cloth which is gone.
pub(crate) fn wake_carried(
    _gone: On<Remove<Particles>>,
    mut obstacles: Query<(&ObstacleOf, &mut Load)>,
    sleeping: Query<(), With<Sleeping>>,
    mut commands: Commands,
) {
    for (of, mut load) in &mut obstacles {
        if load.is_carried() && sleeping.contains(of.0) {
            commands.queue(WakeBody(of.0));
            *load = Load::default();
        }
    }
}

impl Load {
    /// True if cloth carries a good part of the body.
    fn is_carried(&self) -> bool {
        self.acceleration.length() > WAKING_CHANGE
    }
}

/// A sleeping body wakes if the acceleration by which cloth holds or pushes it changes by this much (m/s^2): half its
/// weight on earth.
const WAKING_CHANGE: f32 = 5.0;

/// The part of each step in the mean of a load.
const LOAD_PART: f32 = 0.1;
