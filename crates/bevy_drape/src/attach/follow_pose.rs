//! Pins, limits, backstops and drives that follow an animated pose.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::constants::TELEPORT_SPEED;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment_state::AttachmentState;
use crate::attach::teleport::teleport;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::Particles;
use crate::clock::DrapeClock;
use crate::refusal::Refusals;
use crate::rigid_motion::placement;

/// Moves pins, motion limits, backstops and drives to their animated positions. A jump faster than [`TELEPORT_SPEED`]
/// teleports the whole body, and so does every move of a culled one.
pub(crate) fn move_posed(
    mut bodies: Query<(
        Entity,
        &mut AnimatedPose,
        &mut Particles,
        &mut BodyState,
        &Activity,
        Option<&mut AttachmentState>,
    )>,
    places: Query<&GlobalTransform>,
    clock: Res<DrapeClock>,
    mut refusals: ResMut<Refusals>,
    mut matrices: Local<Vec<Affine3A>>,
) {
    let longest_pull = TELEPORT_SPEED * clock.delta();
    for (entity, mut posed, mut particles, mut state, activity, mut tied) in &mut bodies {
        if let Err(joint) = posed.matrices(|joint| places.get(joint).ok(), &mut matrices) {
            let reason = format!("joint {joint} is gone, or not finite; the cloth stays where it was");
            refusals.entity(entity, posed.source, reason);
            continue;
        }
        if *matrices == posed.last {
            continue;
        }
        let now = matrices.get(posed.main).and_then(placement);
        if let (Some(from), Some(to)) = (posed.last_place(), now) {
            let is_jump = from.translation.distance(to.translation) > longest_pull;
            if is_jump || activity.is_carried() {
                teleport(&mut particles, &mut state, tied.as_deref_mut(), Some(&mut posed), (&from, &to));
            }
        }
        for place in &posed.particles {
            let i = place.particle as usize;
            if i >= particles.len() {
                continue;
            }
            let target = place.target(&matrices);
            particles.set_limit_centre(i, target);
            particles.set_drive_place(i, target);
            if particles.backstop(i).is_some() {
                particles.set_backstop_pose(i, target, place.normal(&matrices));
            }
            if tied.as_ref().is_none_or(|tied| !tied.holds(place.particle)) {
                particles.set_pin_target(i, target);
            }
        }
        posed.last.clone_from(&matrices);
    }
}
