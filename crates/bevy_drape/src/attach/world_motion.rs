//! How much of a character's motion its clothes inherit.

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

/// How much a body feels of the motion of an entity, usually the root of the character that wears it.
///
/// A cape on somebody who runs, jumps and turns flies like a flag, as it would; games want it calmer. What a body is not to feel, it
/// is carried along by, as if it were in a carriage that moves so. Unity's cloth calls these numbers `worldVelocityScale`, `NvCloth` has them
/// as inertia.
///
/// A reference that goes farther than [`teleport_distance`](Self::teleport_distance) in one step has been put somewhere else: the body
/// goes along as it is, turned as the reference turns, and obstacles among the reference's descendants are
/// [teleported](TeleportObstacle). [`TeleportCloth`] says so of shorter ways.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(WorldMotionState)]
pub struct WorldMotion {
    /// The entity whose motion counts; by default the one that this is on.
    #[entities]
    pub reference: Option<Entity>,
    /// How much of its translation is felt: 0 (none) to 1 (all, the default).
    pub linear: f32,
    /// How much of its turning is felt, about its origin, likewise.
    pub angular: f32,
    /// A way in one step, in metres, that is a teleport: 2 by default, which is 120 m/s at 60 Hz. Infinite for none.
    pub teleport_distance: f32,
}

impl Default for WorldMotion {
    fn default() -> Self {
        Self { reference: None, linear: 1.0, angular: 1.0, teleport_distance: 2.0 }
    }
}

impl WorldMotion {
    /// Of `reference`, all of which is felt.
    pub fn of(reference: Entity) -> Self {
        Self { reference: Some(reference), ..Self::default() }
    }

    /// Sets how much is felt of translation and of turning, 0 to 1.
    pub fn with_scale(mut self, linear: f32, angular: f32) -> Self {
        (self.linear, self.angular) = (linear, angular);
        self
    }
}

/// Marks a body whose [`Transform`], character or [attachment](Attachment) is set to somewhere else and that is not to be pulled
/// there: the next step takes it along as it is, with its velocities turned. The step takes the mark off.
///
/// What counts is the motion of the [`WorldMotion`]'s reference; without one that of the joint that most of a skinned cloth hangs on, of the
/// first entity that it is tied to, or of its own entity.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct TeleportCloth;

/// Where the reference was in the last step.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct WorldMotionState {
    pub last: Option<Affine3A>,
}

/// Carries bodies along with what they do not feel of their references' motions.
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
