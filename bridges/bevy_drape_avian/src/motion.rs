//! Takes the motion of dynamic bodies over from Avian, and hands it back.

use avian3d::dynamics::solver::islands::WakeBody;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::environment::{DynamicObstacle, ObstacleReaction, PlannedPlacement};
use bevy_drape::prelude::*;

use crate::frame::InertialFrame;
use crate::marks::{LeftAt, Load, ObstacleOf};

/// Puts obstacles where their bodies begin Avian's step, if anything has moved the bodies since the last one.
pub(crate) fn start(
    mut obstacles: Query<(&ObstacleOf, &InertialFrame, &LeftAt, &mut Transform)>,
    bodies: Query<(&Position, &Rotation)>,
) {
    for (of, frame, left, mut transform) in &mut obstacles {
        let Ok((position, rotation)) = bodies.get(of.0) else { continue };
        if LeftAt::new(position, rotation) != *left {
            let place = frame.of_body(position, rotation);
            *transform = Transform { translation: place.translation, rotation: place.rotation, ..*transform };
        }
    }
}

/// Tells each obstacle where Avian's step has brought its body.
pub(crate) fn plan(
    mut obstacles: Query<(&ObstacleOf, &InertialFrame, &mut PlannedPlacement, &mut DynamicObstacle)>,
    bodies: Query<(
        &Position,
        &Rotation,
        &LinearVelocity,
        &AngularVelocity,
        Option<&LockedAxes>,
        Has<Sleeping>,
    )>,
    time: Res<Time<Physics>>,
) {
    for (of, frame, mut planned, mut dynamic) in &mut obstacles {
        let Ok((position, rotation, velocity, spin, locked, is_sleeping)) = bodies.get(of.0) else {
            continue;
        };
        let place = frame.of_body(position, rotation);
        *planned = PlannedPlacement { translation: place.translation, rotation: place.rotation };
        // Cloth is held by a body that does not move, and wakes it if need be.
        let is_still = is_sleeping || time.is_paused();
        let locked = if is_still { LockedAxes::ALL_LOCKED } else { locked.copied().unwrap_or_default() };
        let is_locked = |bit: u8| locked.to_bits() >> bit & 1 == 1;
        *dynamic = DynamicObstacle {
            velocity: if is_still { Vec3::ZERO } else { velocity.0 },
            angular_velocity: if is_still { Vec3::ZERO } else { spin.0 },
            locked_translation: [5, 4, 3].map(is_locked),
            locked_rotation: [2, 1, 0].map(is_locked),
            ..*dynamic
        };
    }
}

/// Moves the bodies that cloth has pushed to where it left them, and wakes those that it pushes otherwise than it did
/// when they fell asleep.
pub(crate) fn hand_back(
    mut obstacles: Query<(
        &ObstacleOf,
        &InertialFrame,
        &Transform,
        &DynamicObstacle,
        &ObstacleReaction,
        &mut LeftAt,
        &mut Load,
    )>,
    mut bodies: Query<(
        &mut Position,
        &mut Rotation,
        &mut LinearVelocity,
        &mut AngularVelocity,
        Has<Sleeping>,
    )>,
    mut commands: Commands,
    clock: (Res<Time>, Res<Time<Physics>>),
) {
    let (clock, physics) = clock;
    for (of, frame, transform, dynamic, reaction, mut left, mut load) in &mut obstacles {
        let Ok((mut position, mut rotation, mut velocity, mut spin, is_sleeping)) = bodies.get_mut(of.0)
        else {
            continue;
        };
        let push = reaction.impulse / dynamic.mass;
        let acceleration = push / clock.delta_secs();
        if is_sleeping {
            if reaction.is_near && acceleration.distance(load.0) > WAKING_CHANGE {
                commands.queue(WakeBody(of.0));
                velocity.0 += push;
            }
        } else if !physics.is_paused() {
            if reaction.impulse != Vec3::ZERO || reaction.angular_impulse != Vec3::ZERO {
                (*position, *rotation) = frame.body_at(transform.translation, transform.rotation);
                (velocity.0, spin.0) = (dynamic.velocity, dynamic.angular_velocity);
            }
            load.0 = load.0.lerp(acceleration, LOAD_PART);
        }
        *left = LeftAt::new(&position, &rotation);
    }
}

/// Wakes bodies that slept on cloth which is gone.
pub(crate) fn wake_carried(
    _gone: On<Remove<Particles>>,
    obstacles: Query<(&ObstacleOf, &Load)>,
    sleeping: Query<(), With<Sleeping>>,
    mut commands: Commands,
) {
    for (of, load) in &obstacles {
        if load.0.length() > WAKING_CHANGE && sleeping.contains(of.0) {
            commands.queue(WakeBody(of.0));
        }
    }
}

/// A sleeping body wakes if the acceleration by which cloth holds or pushes it changes by this much (m/s^2): half its
/// weight on earth.
const WAKING_CHANGE: f32 = 5.0;

/// The part of each step in the mean of a load.
const LOAD_PART: f32 = 0.1;
