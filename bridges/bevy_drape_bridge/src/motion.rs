//! Takes the motion of dynamic bodies over from their engine, and hands it back.

use bevy::prelude::*;
use bevy_drape::drape_solver::Placement;
use bevy_drape::environment::{DynamicObstacle, ObstacleReaction, PlannedPlacement};

use crate::frame::InertialFrame;

/// On the obstacle of a dynamic body: the state of the body, by which engine and cloth pass it to each other.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct EngineBody {
    /// Place of the body's origin.
    pub place: Placement,
    /// Velocity of its centre of mass in m/s.
    pub velocity: Vec3,
    /// Angular velocity in rad/s.
    pub angular_velocity: Vec3,
    /// World axes along which nothing moves it.
    pub locked_translation: [bool; 3],
    /// World axes about which nothing turns it.
    pub locked_rotation: [bool; 3],
    /// Speeds in m/s and rad/s below which it may fall asleep; if they are below 0 it never does.
    pub sleep_speeds: [f32; 2],
    /// True if it sleeps: it does not move, and holds what lies on it.
    pub is_asleep: bool,
    /// True if its engine is paused, with the same effect on cloth. Nothing wakes it then.
    pub is_paused: bool,
    /// True after a step in which cloth has pushed it: place and velocities are those that cloth has left it with.
    pub is_pushed: bool,
    /// The place at the end of the last step of cloth.
    pub left: Placement,
}

impl EngineBody {
    fn is_held(&self) -> bool {
        self.is_asleep || self.is_paused
    }

    /// True if nothing has moved the body since the last step of cloth.
    fn is_where_it_was_left(&self) -> bool {
        self.place == self.left
    }
}

/// True if cloth has pushed a body in its last step.
pub fn is_any_pushed(bodies: Query<&EngineBody>) -> bool {
    bodies.iter().any(|body| body.is_pushed)
}

/// Puts obstacles where their bodies begin the engine's step, if anything has moved the bodies since the last one.
pub(crate) fn start(mut obstacles: Query<(&InertialFrame, &EngineBody, &mut Transform)>) {
    for (frame, body, mut transform) in &mut obstacles {
        if !body.is_where_it_was_left() {
            let Placement { translation, rotation } = frame.of_body(body.place);
            *transform = Transform { translation, rotation, ..*transform };
        }
    }
}

/// Tells each obstacle where the engine's step has brought its body.
pub(crate) fn plan(
    mut obstacles: Query<(
        &InertialFrame,
        &EngineBody,
        &Transform,
        &mut PlannedPlacement,
        &mut DynamicObstacle,
    )>,
) {
    for (frame, body, transform, mut planned, mut dynamic) in &mut obstacles {
        let Placement { translation, rotation } = if body.is_where_it_was_left() {
            // Rounding on the way from body to frame would be a motion, and keep what lies on it awake.
            Placement { translation: transform.translation, rotation: transform.rotation }
        } else {
            frame.of_body(body.place)
        };
        *planned = PlannedPlacement { translation, rotation };
        let moving = |velocity| if body.is_held() { Vec3::ZERO } else { velocity };
        *dynamic = DynamicObstacle {
            velocity: moving(body.velocity),
            angular_velocity: moving(body.angular_velocity),
            locked_translation: body.locked_translation.map(|is_locked| is_locked || body.is_held()),
            locked_rotation: body.locked_rotation.map(|is_locked| is_locked || body.is_held()),
            ..*dynamic
        };
    }
}

/// Notes where cloth has left the bodies that it has pushed.
pub(crate) fn hand_back(
    mut obstacles: Query<(&InertialFrame, &Transform, &DynamicObstacle, &ObstacleReaction, &mut EngineBody)>,
) {
    for (frame, transform, dynamic, reaction, mut body) in &mut obstacles {
        let is_touched = reaction.impulse != Vec3::ZERO || reaction.angular_impulse != Vec3::ZERO;
        body.is_pushed = is_touched && !body.is_held();
        if body.is_pushed {
            let Transform { translation, rotation, .. } = *transform;
            body.place = frame.body_at(Placement { translation, rotation });
            (body.velocity, body.angular_velocity) = (dynamic.velocity, dynamic.angular_velocity);
        }
        body.left = body.place;
    }
}
