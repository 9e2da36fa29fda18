//! Reads the motion of dynamic bodies, writes it back, and wakes them.

use bevy::prelude::*;
use bevy_drape_bridge::{EngineBody, Load, ObstacleOf, WakeRequest};
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextSimulation, RapierRigidBodySet,
};
use bevy_rapier3d::prelude::RapierRigidBodyHandle;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;
use bevy_rapier3d::rapier::geometry::Collider;
use bevy_rapier3d::rapier::math::Pose;

use crate::world::{RapierWorld, placement};

/// Reads all dynamic bodies: where Rapier's step begins, and where it ends.
pub(crate) fn read(mut obstacles: Query<(&ObstacleOf, &mut EngineBody)>, world: RapierWorld) {
    for (of, mut body) in &mut obstacles {
        let Some(rapier) = world.body(of.0) else { continue };
        let (locked, activation) = (rapier.locked_axes().bits(), rapier.activation());
        let is_locked = |bit: u8| locked >> bit & 1 == 1;
        let place = placement(rapier.position());
        let has_moved = place != body.place;
        *body = EngineBody {
            place,
            velocity: rapier.linvel(),
            angular_velocity: rapier.angvel(),
            locked_translation: [0, 1, 2].map(is_locked),
            locked_rotation: [3, 4, 5].map(is_locked),
            // Rapier goes on moving a body that was sent to sleep if something else wakes what it touches.
            is_asleep: rapier.is_sleeping() && !has_moved,
            sleep_speeds: [activation.normalized_linear_threshold, activation.angular_threshold],
            is_paused: world.is_paused(of.0),
            ..*body
        };
    }
}

/// Moves the bodies that cloth has pushed to where it left them, and sends those to sleep that have been still for long
/// enough: Rapier would not, since a body that is moved by hand, even by a hair, stays awake.
pub(crate) fn write(
    mut obstacles: Query<(&ObstacleOf, &EngineBody, &mut Load)>,
    bodies: Query<(&RapierRigidBodyHandle, &RapierContextEntityLink)>,
    mut contexts: Query<(&mut RapierRigidBodySet, &RapierContextColliders, &RapierContextSimulation)>,
    mut sleepers: Local<Vec<(Entity, RigidBodyHandle)>>,
) {
    sleepers.clear();
    for (of, _, load) in obstacles.iter().filter(|(_, body, _)| body.is_pushed) {
        let Ok((handle, link)) = bodies.get(of.0) else { continue };
        let rapier = contexts.get(link.0).ok().and_then(|(set, ..)| set.bodies.get(handle.0));
        if rapier.is_some_and(|rapier| load.still_for >= rapier.activation().time_until_sleep) {
            sleepers.push((link.0, handle.0));
        }
    }
    keep_still_groups(&mut sleepers, &contexts);
    for (of, body, mut load) in obstacles.iter_mut().filter(|(_, body, _)| body.is_pushed) {
        let Ok((handle, link)) = bodies.get(of.0) else { continue };
        let Ok((set, ..)) = contexts.get_mut(link.0) else { continue };
        let Some(rapier) = set.into_inner().bodies.get_mut(handle.0) else { continue };
        if rapier.is_sleeping() {
            rapier.wake_up(true);
            load.still_for = 0.0;
        } else if sleepers.contains(&(link.0, handle.0)) {
            rapier.sleep();
            continue;
        }
        rapier.set_position(Pose::from_parts(body.place.translation, body.place.rotation), false);
        rapier.set_linvel(body.velocity, false);
        rapier.set_angvel(body.angular_velocity, false);
    }
}

/// Keeps only those bodies that can sleep together: Rapier wakes a body next to one that is moved by hand, and goes on moving one that
/// touches a body which is awake.
fn keep_still_groups(
    sleepers: &mut Vec<(Entity, RigidBodyHandle)>,
    contexts: &Query<(&mut RapierRigidBodySet, &RapierContextColliders, &RapierContextSimulation)>,
) {
    let is_next_to_restless = |sleepers: &[(Entity, RigidBodyHandle)], (context, handle)| {
        let Ok((set, colliders, simulation)) = contexts.get(context) else { return true };
        let parent = |collider| colliders.colliders.get(collider).and_then(Collider::parent);
        let is_restless = |other: RigidBodyHandle| {
            set.bodies.get(other).is_some_and(|body| {
                let activation = body.activation();
                body.is_dynamic()
                    && !body.is_sleeping()
                    && activation.time_since_can_sleep < activation.time_until_sleep
                    && !sleepers.contains(&(context, other))
            })
        };
        let own = set.bodies.get(handle).into_iter().flat_map(|body| body.colliders());
        let pairs = own.flat_map(|&own| simulation.narrow_phase.contact_pairs_with(own));
        let others = pairs.flat_map(|pair| [pair.collider1, pair.collider2]).filter_map(parent);
        others.into_iter().any(is_restless)
    };
    while let Some(place) = sleepers.iter().position(|&sleeper| is_next_to_restless(sleepers, sleeper)) {
        sleepers.remove(place);
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
