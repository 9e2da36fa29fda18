//! Reads the motion of dynamic bodies, writes it back, and wakes them.

use bevy::prelude::*;
use bevy_drape_bridge::{EngineBody, Load, ObstacleOf, WakeRequest};
use bevy_rapier3d::plugin::context::{RapierContextEntityLink, RapierContextSimulation, RapierRigidBodySet};
use bevy_rapier3d::prelude::RapierRigidBodyHandle;
use bevy_rapier3d::rapier::math::Pose;

use crate::world::{RapierWorld, placement};

/// Reads all dynamic bodies: where Rapier's step begins, and where it ends.
pub(crate) fn read(mut obstacles: Query<(&ObstacleOf, &mut EngineBody)>, world: RapierWorld) {
    for (of, mut body) in &mut obstacles {
        let Some(rapier) = world.body(of.0) else { continue };
        let (locked, activation) = (rapier.locked_axes().bits(), rapier.activation());
        let is_locked = |bit: u8| locked >> bit & 1 == 1;
        *body = EngineBody {
            place: placement(rapier.position()),
            velocity: rapier.linvel(),
            angular_velocity: rapier.angvel(),
            locked_translation: [0, 1, 2].map(is_locked),
            locked_rotation: [3, 4, 5].map(is_locked),
            is_asleep: rapier.is_sleeping(),
            sleep_speeds: [activation.normalized_linear_threshold, activation.angular_threshold],
            is_paused: world.is_paused(of.0),
            ..*body
        };
    }
}

/// Moves the bodies that cloth has pushed to where it left them, and sends those to sleep that have been still for long
/// enough: Rapier would not, since a body that is moved by hand, even by a hair, stays awake.
pub(crate) fn write(
    obstacles: Query<(&ObstacleOf, &EngineBody, &Load)>,
    bodies: Query<(&RapierRigidBodyHandle, &RapierContextEntityLink)>,
    mut sets: Query<&mut RapierRigidBodySet>,
) {
    for (of, body, load) in obstacles.iter().filter(|(_, body, _)| body.is_pushed) {
        let Ok((handle, link)) = bodies.get(of.0) else { continue };
        let Ok(set) = sets.get_mut(link.0) else { continue };
        let Some(rapier) = set.into_inner().bodies.get_mut(handle.0) else { continue };
        if load.still_for >= rapier.activation().time_until_sleep {
            rapier.set_linvel(Vec3::ZERO, false);
            rapier.set_angvel(Vec3::ZERO, false);
            rapier.sleep();
        } else {
            rapier.set_position(Pose::from_parts(body.place.translation, body.place.rotation), false);
            rapier.set_linvel(body.velocity, false);
            rapier.set_angvel(body.angular_velocity, false);
        }
    }
}

/// Wakes a body for cloth, and all that touches it.
pub(crate) fn wake(
    request: On<WakeRequest>,
    bodies: Query<(&RapierRigidBodyHandle, &RapierContextEntityLink)>,
    mut contexts: Query<(&mut RapierRigidBodySet, &mut RapierContextSimulation)>,
) {
    let Ok((handle, link)) = bodies.get(request.entity) else { return };
    if let Ok((mut set, mut simulation)) = contexts.get_mut(link.0) {
        simulation.islands.wake_up(&mut set.bodies, handle.0, true);
    }
}
