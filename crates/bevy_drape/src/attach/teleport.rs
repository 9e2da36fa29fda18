//! Teleports of bodies.

use drape_solver::Placement;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment_state::AttachmentState;
use crate::body::body_state::BodyState;
use crate::rigid_motion::rigid_way;

/// Moves a body rigidly, and with it the stored poses that it follows.
pub(crate) fn teleport(
    particles: &mut drape_solver::Particles,
    state: &mut BodyState,
    tied: Option<&mut AttachmentState>,
    posed: Option<&mut AnimatedPose>,
    (from, to): (&Placement, &Placement),
) {
    particles.teleport(from, to);
    let way = rigid_way(from, to);
    state.anchor = way * state.anchor;
    let poses = tied.into_iter().flat_map(|tied| tied.poses.iter_mut().flatten());
    poses.chain(posed.into_iter().flat_map(|posed| &mut posed.last)).for_each(|pose| *pose = way * *pose);
}
