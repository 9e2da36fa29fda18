//! The part of a character's motion that its clothes feel.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::FrameMotion;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment::Attachment;
use crate::attach::attachment_state::AttachmentState;
use crate::attach::teleport::teleport;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::Particles;
use crate::environment::obstacle::{Obstacle, TeleportObstacle};
use crate::refusal::Refusals;
use crate::rigid_motion::placement;

/// Scales the motion of an entity, usually the root of a character, that its clothes feel.
///
/// A cape on a running character flies like a flag; games often want it calmer. The body is carried along with the rest
/// of the motion, as if it rode in a carriage. Unity's cloth calls these numbers `worldVelocityScale`, `NvCloth`
/// inertia.
///
/// A reference that moves farther than [`teleport_distance`](Self::teleport_distance) in one step counts as teleported.
/// The body moves with it rigidly, and obstacles among its descendants are [teleported](TeleportObstacle) too. Use
/// [`TeleportCloth`] for shorter teleports.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(WorldMotionState)]
pub struct WorldMotion {
    /// The entity whose motion counts; by default the body's own.
    #[entities]
    pub reference: Option<Entity>,
    /// The part of its translation that is felt: 0 (none) to 1 (all, the default).
    pub linear: f32,
    /// The part of its rotation about its origin that is felt: 0 to 1, the default.
    pub angular: f32,
    /// Distance in one step, in metres, beyond which the reference counts as teleported; 2 by default, which is 120 m/s
    /// at 60 Hz. Infinite for never.
    pub teleport_distance: f32,
}

impl Default for WorldMotion {
    fn default() -> Self {
        Self { reference: None, linear: 1.0, angular: 1.0, teleport_distance: 2.0 }
    }
}

impl WorldMotion {
    /// Feels the whole motion of `reference`.
    pub fn of(reference: Entity) -> Self {
        Self { reference: Some(reference), ..Self::default() }
    }

    /// Sets the parts of translation and rotation that are felt, 0 to 1.
    pub fn with_scale(mut self, linear: f32, angular: f32) -> Self {
        (self.linear, self.angular) = (linear, angular);
        self
    }
}

/// Marks a body whose [`Transform`], character or [attachment](Attachment) was set to another place and that must not
/// be pulled there. The next step moves the body rigidly, turns its velocities, and removes the mark.
///
/// The body moves with the [`WorldMotion`]'s reference; without one, with the main joint of a skinned cloth, the first
/// entity that it is tied to, or its own entity.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct TeleportCloth;

/// The pose of the reference in the last step.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct WorldMotionState {
    pub last: Option<Affine3A>,
}

/// Carries bodies along with the part of their references' motion that they do not feel.
pub(crate) fn inherit_motion(
    mut commands: Commands,
    mut bodies: Query<
        (
            Entity,
            &mut Particles,
            &mut BodyState,
            &Activity,
            &GlobalTransform,
            Option<(&WorldMotion, &mut WorldMotionState)>,
            Option<(&Attachment, &mut AttachmentState)>,
            Option<&mut AnimatedPose>,
            Has<TeleportCloth>,
        ),
        Or<(With<WorldMotion>, With<TeleportCloth>)>,
    >,
    places: Query<&GlobalTransform>,
    children: Query<&Children>,
    obstacles: Query<(), With<Obstacle>>,
    mut refusals: ResMut<Refusals>,
) {
    for (entity, mut particles, mut body, activity, own, motion, tied, posed, is_teleport) in &mut bodies {
        if is_teleport {
            commands.entity(entity).remove::<TeleportCloth>();
        }
        let place = |entity: Entity| places.get(entity).ok().map(GlobalTransform::affine);
        let mut scale = (1.0, 1.0, f32::INFINITY);
        let mut reference = entity;
        let mut before = None;
        if let Some((motion, mut state)) = motion {
            let shares = [motion.linear, motion.angular];
            if shares.iter().all(|share| (0.0..=1.0).contains(share)) && motion.teleport_distance >= 0.0 {
                refusals.forget_component(entity, "WorldMotion");
                scale = (motion.linear, motion.angular, motion.teleport_distance);
            } else {
                let reason = "linear and angular must be from 0 to 1, and teleport_distance 0 or more";
                refusals.entity(entity, "WorldMotion", reason);
            }
            reference = motion.reference.unwrap_or(entity);
            let now = place(reference).filter(Affine3A::is_finite);
            before = state.last.map(|last| (last, now));
            state.last = now.or(state.last);
        }
        let (mut tied, mut posed) = (tied, posed);
        let from_to = before.or_else(|| {
            if let Some(posed) = posed.as_ref().filter(|posed| !posed.last.is_empty()) {
                reference = posed.joints[posed.main];
                let now = place(reference).map(|now| now * posed.inverse_bind_poses[posed.main]);
                return Some((posed.last[posed.main], now));
            }
            if let Some((attachment, state)) = &tied
                && let (Some(tie), Some(Some(last))) = (attachment.ties.first(), state.poses.first())
            {
                reference = tie.entity;
                return Some((*last, place(reference)));
            }
            Some((body.anchor, Some(own.affine())))
        });
        let Some((last, Some(now))) = from_to else { continue };
        let (Some(from), Some(to)) = (placement(&last), placement(&now)) else { continue };
        if last == now {
            continue;
        }
        let (linear, angular, teleport_distance) = scale;
        if is_teleport || from.translation.distance(to.translation) > teleport_distance {
            let tied = tied.as_mut().map(|(_, tied)| &mut **tied);
            teleport(&mut particles, &mut body, tied, posed.as_deref_mut(), (&from, &to));
            let worn = children.iter_descendants(reference).filter(|&child| obstacles.contains(child));
            for obstacle in worn.chain([reference].into_iter().filter(|&entity| obstacles.contains(entity))) {
                commands.entity(obstacle).insert(TeleportObstacle);
            }
        } else if !activity.is_carried() {
            particles.move_frame(FrameMotion::between(&from, &to).scaled(1.0 - linear, 1.0 - angular));
        }
    }
}
