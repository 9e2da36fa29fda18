//! Moves tied particles to the entities that they are tied to.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::constants::TELEPORT_SPEED;

use crate::attach::attachment::{Attachment, Tie};
use crate::attach::attachment_state::{AttachmentState, HeldParticle};
use crate::attach::teleport::teleport;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::Particles;
use crate::clock::DrapeClock;
use crate::refusal::Refusals;
use crate::rigid_motion::placement;

/// Moves tied particles with the entities that they are tied to.
pub(crate) fn move_attached(
    mut bodies: Query<(Entity, &Attachment, &mut AttachmentState, &mut Particles, &mut BodyState, &Activity)>,
    targets: Query<&GlobalTransform>,
    clock: Res<DrapeClock>,
    mut refusals: ResMut<Refusals>,
) {
    let longest_pull = TELEPORT_SPEED * clock.delta();
    for (entity, attachment, mut state, mut particles, mut body, activity) in &mut bodies {
        let state = &mut *state;
        let pose = |target: Entity| targets.get(target).ok().map(GlobalTransform::affine);
        let finite_pose = |target: Entity| pose(target).filter(Affine3A::is_finite);
        // Ties whose entity was missing until now.
        let mut waiting = attachment.ties.iter().zip(&state.poses).filter(|(_, pose)| pose.is_none());
        let has_come = waiting.any(|(tie, _)| finite_pose(tie.entity).is_some());
        if has_come || state.made_of != *attachment || state.body != body.order {
            refusals.forget_component(entity, "Attachment");
            if state.body != body.order {
                *state = AttachmentState { body: body.order, ..default() };
            }
            let made = state.make(attachment, &mut particles, finite_pose);
            state.body = body.order;
            if let Err(index) = made {
                let reason = format!("there is no particle {index}: it has {}", particles.len());
                refusals.entity(entity, "Attachment", reason);
            }
        }
        for (place, Tie { entity: target, .. }) in attachment.ties.iter().enumerate() {
            let Some(before) = state.poses.get(place).copied().flatten() else { continue };
            let Some(now) = pose(*target) else {
                info!(
                    "Attachment of entity {entity}: {target}, which it is tied to, is gone, and the tie with it"
                );
                state.release(&mut particles, |tie| tie as usize == place);
                state.held.retain(|held| held.tie as usize != place);
                state.poses[place] = None;
                continue;
            };
            if now == before {
                continue;
            }
            if !now.is_finite() {
                let reason = "it must be finite; what is tied to it stays where it was";
                refusals.entity(*target, "the new Transform", reason);
                continue;
            }
            let held = || state.held.iter().filter(|held| held.tie as usize == place);
            let is_pull = |held: &HeldParticle| {
                let [from, to] = [before, now].map(|pose| pose.transform_point3(held.local));
                from.distance(to) <= longest_pull
            };
            let is_jump = activity.is_carried() || !held().all(is_pull);
            if is_jump && let (Some(from), Some(to)) = (placement(&before), placement(&now)) {
                teleport(&mut particles, &mut body, Some(&mut *state), None, (&from, &to));
            }
            state.poses[place] = Some(now);
            let held = state.held.iter().filter(|held| held.tie as usize == place);
            for held in held {
                let i = held.particle as usize;
                if i < particles.len() {
                    particles.set_pin_target(i, now.transform_point3(held.local));
                }
            }
        }
    }
}

/// Releases all tied particles of a body that loses its [`Attachment`].
pub(crate) fn release_attached(
    removed: On<Remove<Attachment>>,
    mut bodies: Query<(&mut AttachmentState, &mut Particles)>,
) {
    if let Ok((mut state, mut particles)) = bodies.get_mut(removed.entity) {
        state.release(&mut particles, |_| true);
        particles.clear_joints();
        *state = AttachmentState::default();
    }
}
