//! Pins that follow the transform of their entity.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::constants::TELEPORT_SPEED;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment_state::AttachmentState;
use crate::attach::teleport::teleport;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::Particles;
use crate::change_detection::collect_changed;
use crate::clock::DrapeClock;
use crate::refusal::Refusals;
use crate::rigid_motion::placement;

/// True if one of these pins, in the coordinates of an entity that moves from one transform to another, goes farther than `longest_pull`.
pub(crate) fn is_jump<'a>(
    mut pins: impl Iterator<Item = &'a (u32, Vec3)>,
    way: [&Affine3A; 2],
    longest_pull: f32,
) -> bool {
    pins.any(|&(_, local)| {
        let [from, to] = way.map(|anchor| anchor.transform_point3(local));
        from.distance(to) > longest_pull
    })
}

/// Moves pins with their entity; they pull the cloth along. A jump faster than [`TELEPORT_SPEED`] teleports the whole
/// body, and so does every move of a culled one.
pub(crate) fn move_pins(
    anchors: Query<(Entity, Ref<GlobalTransform>), With<BodyState>>,
    mut bodies: Query<
        (&GlobalTransform, &Activity, &mut Particles, &mut BodyState, Option<&mut AttachmentState>),
        Without<AnimatedPose>,
    >,
    clock: Res<DrapeClock>,
    mut refusals: ResMut<Refusals>,
    mut moved: Local<Vec<Entity>>,
) {
    let longest_pull = TELEPORT_SPEED * clock.delta();
    collect_changed(&anchors, &mut moved);
    for entity in moved.drain(..) {
        let Ok((transform, activity, mut particles, mut state, mut tied)) = bodies.get_mut(entity) else {
            continue;
        };
        let anchor = transform.affine();
        if anchor == state.anchor || state.pins.is_empty() {
            continue;
        }
        if !anchor.is_finite() {
            refusals.entity(entity, "the new Transform", "it must be finite; the pins stay where they were");
            continue;
        }
        let is_own = |tied: Option<&AttachmentState>, pin: u32| tied.is_none_or(|tied| !tied.holds(pin));
        let mut own = state.pins.iter().filter(|&&(pin, _)| is_own(tied.as_deref(), pin)).peekable();
        let has_own = own.peek().is_some();
        let is_jump =
            has_own && (activity.is_carried() || is_jump(own, [&state.anchor, &anchor], longest_pull));
        if is_jump && let (Some(from), Some(to)) = (placement(&state.anchor), placement(&anchor)) {
            teleport(&mut particles, &mut state, tied.as_deref_mut(), None, (&from, &to));
        }
        for &(pin, local) in &state.pins {
            let i = pin as usize;
            if i < particles.len() && is_own(tied.as_deref(), pin) {
                particles.set_pin_target(i, anchor.transform_point3(local));
            }
        }
        state.anchor = anchor;
    }
}
