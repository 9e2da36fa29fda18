//! Takes the motion of dynamic bodies over from Avian, and hands it back.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::drape_solver::Placement;
use bevy_drape::environment::{DynamicObstacle, ObstacleReaction, PlannedPlacement};

use crate::frame::InertialFrame;
use crate::marks::{LeftAt, ObstacleOf};

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
    mut obstacles: Query<(
        &ObstacleOf,
        &InertialFrame,
        &LeftAt,
        &Transform,
        &mut PlannedPlacement,
        &mut DynamicObstacle,
    )>,
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
    for (of, frame, left, transform, mut planned, mut dynamic) in &mut obstacles {
        let Ok((position, rotation, velocity, spin, locked, is_sleeping)) = bodies.get(of.0) else {
            continue;
        };
        let Transform { translation, rotation: turn, .. } = *transform;
        let place = if LeftAt::new(position, rotation) == *left {
            // Rounding on the way from body to frame would be a motion, and keep what lies on it awake.
            Placement { translation, rotation: turn }
        } else {
            frame.of_body(position, rotation)
        };
        *planned = PlannedPlacement { translation: place.translation, rotation: place.rotation };
        // A body that does not move holds what lies on it.
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

/// Moves the bodies that cloth has pushed to where it left them.
pub(crate) fn hand_back(
    mut obstacles: Query<(
        &ObstacleOf,
        &InertialFrame,
        &Transform,
        &DynamicObstacle,
        &ObstacleReaction,
        &mut LeftAt,
    )>,
    mut bodies: Query<(
        &mut Position,
        &mut Rotation,
        &mut LinearVelocity,
        &mut AngularVelocity,
        Has<Sleeping>,
    )>,
    time: Res<Time<Physics>>,
) {
    for (of, frame, transform, dynamic, reaction, mut left) in &mut obstacles {
        let Ok((mut position, mut rotation, mut velocity, mut spin, is_sleeping)) = bodies.get_mut(of.0)
        else {
            continue;
        };
        let is_touched = reaction.impulse != Vec3::ZERO || reaction.angular_impulse != Vec3::ZERO;
        if is_touched && !is_sleeping && !time.is_paused() {
            (*position, *rotation) = frame.body_at(transform.translation, transform.rotation);
            (velocity.0, spin.0) = (dynamic.velocity, dynamic.angular_velocity);
        }
        *left = LeftAt::new(&position, &rotation);
    }
}
