//! Reads the motion of dynamic bodies, writes it back, and wakes them.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use bevy_drape_bridge::{BodyObstacle, BodyReach, EngineBody, Load, ObstacleOf, Surroundings, WakeRequest};
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextJoints, RapierContextSimulation,
    RapierRigidBodySet,
};
use bevy_rapier3d::prelude::RapierRigidBodyHandle;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::Collider;
use bevy_rapier3d::rapier::math::Pose;

use crate::world::{RapierWorld, placement};

/// Looks which dynamic bodies are near cloth.
pub(crate) fn find_near(
    mut bodies: Query<(Entity, &BodyObstacle, &mut BodyReach)>,
    mut surroundings: ResMut<Surroundings>,
    world: RapierWorld,
    time: Res<Time>,
) {
    for (entity, obstacle, mut reach) in &mut bodies {
        let Some(body) = world.body(entity) else { continue };
        let seconds = if world.is_paused(entity) { 0.0 } else { time.delta_secs() };
        surroundings.look_at(obstacle, &mut reach, placement(body.position()), body.linvel(), seconds);
    }
}

/// Reads all dynamic bodies near cloth: where Rapier's step begins, and where it ends.
pub(crate) fn read(mut obstacles: Query<(&ObstacleOf, &mut EngineBody)>, world: RapierWorld) {
    for (of, mut body) in &mut obstacles {
        let Some(rapier) = world.body(of.0) else { continue };
        let (locked, activation) = (rapier.locked_axes().bits(), rapier.activation());
        let is_locked = |bit: u8| locked >> bit & 1 == 1;
        let place = placement(rapier.position());
        let has_moved = place != body.place && !body.is_added();
        *body = EngineBody {
            place,
            velocity: rapier.linvel(),
            angular_velocity: rapier.angvel(),
            locked_translation: [0, 1, 2].map(is_locked),
            locked_rotation: [3, 4, 5].map(is_locked),
            // Rapier keeps moving a body that was sent to sleep while its island is awake.
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
    mut contexts: Query<Context>,
    mut still: Local<Vec<(Entity, RigidBodyHandle)>>,
    mut group: Local<Vec<RigidBodyHandle>>,
) {
    still.clear();
    for (of, _, load) in obstacles.iter().filter(|(_, body, _)| body.is_pushed) {
        let Ok((handle, link)) = bodies.get(of.0) else { continue };
        let rapier = contexts.get(link.0).ok().and_then(|context| context.set.bodies.get(handle.0));
        if rapier.is_some_and(|rapier| load.still_for >= rapier.activation().time_until_sleep) {
            still.push((link.0, handle.0));
        }
    }
    for (of, body, mut load) in obstacles.iter_mut().filter(|(_, body, _)| body.is_pushed) {
        let Ok((&RapierRigidBodyHandle(handle), link)) = bodies.get(of.0) else { continue };
        let Ok(mut context) = contexts.get_mut(link.0) else { continue };
        let is_still = |other| still.contains(&(link.0, other));
        let falls_asleep = is_still(handle) && context.is_group_still(handle, is_still, &mut group);
        let Some(rapier) = context.set.bodies.get_mut(handle) else { continue };
        if rapier.is_sleeping() {
            rapier.wake_up(true);
            load.still_for = 0.0;
        } else if falls_asleep {
            rapier.sleep();
            continue;
        }
        rapier.set_position(Pose::from_parts(body.place.translation, body.place.rotation), false);
        rapier.set_linvel(body.velocity, false);
        rapier.set_angvel(body.angular_velocity, false);
    }
}

/// One of Rapier's worlds.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Context {
    set: &'static mut RapierRigidBodySet,
    colliders: &'static RapierContextColliders,
    joints: &'static RapierContextJoints,
    simulation: &'static RapierContextSimulation,
}

impl ContextItem<'_, '_> {
    /// True if the body and all that it is next to or joined to, and so on, can fall asleep together. Rapier wakes a body next to one that
    /// is moved by hand, and keeps moving a body that is sent to sleep while one that it touches is awake. `group` is memory for the bodies.
    fn is_group_still(
        &self,
        handle: RigidBodyHandle,
        is_still: impl Fn(RigidBodyHandle) -> bool,
        group: &mut Vec<RigidBodyHandle>,
    ) -> bool {
        let bodies = &self.set.bodies;
        group.clear();
        group.push(handle);
        let mut next = 0;
        while let Some(&handle) = group.get(next) {
            next += 1;
            let own = bodies.get(handle).into_iter().flat_map(RigidBody::colliders);
            let pairs = own.flat_map(|&own| self.simulation.narrow_phase.contact_pairs_with(own));
            let parent = |collider| self.colliders.colliders.get(collider).and_then(Collider::parent);
            let beside = pairs.flat_map(|pair| [pair.collider1, pair.collider2]).filter_map(parent);
            let joints = self.joints.impulse_joints.attached_joints(handle);
            let joined = joints.flat_map(|(one, other, ..)| [one, other]);
            for other in beside.chain(joined) {
                let is_asleep = |body: &RigidBody| body.is_fixed() || body.is_sleeping();
                let Some(body) = bodies.get(other).filter(|&body| !is_asleep(body)) else { continue };
                if group.contains(&other) {
                    continue;
                }
                let activation = body.activation();
                if !is_still(other) && activation.time_since_can_sleep < activation.time_until_sleep {
                    return false;
                }
                group.push(other);
            }
        }
        true
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
