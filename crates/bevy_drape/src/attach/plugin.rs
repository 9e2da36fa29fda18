//! Registers the ties between particles and entities.

use bevy::prelude::*;

use crate::attach::attachment::{Attachment, Tie, TiedParticles};
use crate::attach::follow_attachment::{move_attached, release_attached};
use crate::attach::follow_particle::{FollowParticle, FollowedParticle, ParticleFollowers, follow_particles};
use crate::attach::follow_pose::move_posed;
use crate::attach::grab::{Grab, Hand, pull_grabbed};
use crate::attach::pins::move_pins;
use crate::attach::plane_lock::{PlaneLock, lock_planes};
use crate::attach::pull_obstacles::join_attached;
use crate::attach::winch::{Winch, turn_winches};
use crate::attach::world_motion::{TeleportCloth, WorldMotion, inherit_motion};
use crate::refusal::forget_removed;
use crate::schedule::{DrapeSchedule, FinishPhase, ScenePhase};

/// Pins that follow their own entity, the joints of a skin, or other entities.
pub(crate) struct AttachmentPlugin;

impl Plugin for AttachmentPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Attachment, Tie, TiedParticles)>()
            .add_observer(release_attached)
            .add_observer(forget_removed::<Attachment>)
            .add_systems(
                DrapeSchedule,
                (
                    move_pins.in_set(ScenePhase::MovePins),
                    move_posed.in_set(ScenePhase::MovePosed),
                    (move_attached, join_attached).chain().in_set(ScenePhase::MoveAttached),
                ),
            );
    }
}

/// Bodies that are carried along with a part of a character's motion.
pub(crate) struct WorldMotionPlugin;

impl Plugin for WorldMotionPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(WorldMotion, TeleportCloth)>()
            .add_observer(forget_removed::<WorldMotion>)
            .add_systems(DrapeSchedule, inherit_motion.in_set(ScenePhase::InheritMotion));
    }
}

/// Hands that hold particles.
pub(crate) struct GrabPlugin;

impl Plugin for GrabPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Grab, Hand)>()
            .add_systems(DrapeSchedule, pull_grabbed.in_set(ScenePhase::PullGrabbed));
    }
}

/// Winches that pay out ropes and reel them in.
pub(crate) struct WinchPlugin;

impl Plugin for WinchPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Winch>()
            .add_observer(forget_removed::<Winch>)
            .add_systems(DrapeSchedule, turn_winches.in_set(ScenePhase::TurnWinches));
    }
}

/// Entities that follow a particle.
pub(crate) struct FollowParticlePlugin;

impl Plugin for FollowParticlePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(FollowParticle, FollowedParticle, ParticleFollowers)>()
            .add_systems(DrapeSchedule, follow_particles.in_set(FinishPhase::FollowParticles));
    }
}

/// Bodies that stay in a plane.
pub(crate) struct PlaneLockPlugin;

impl Plugin for PlaneLockPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PlaneLock>()
            .add_systems(DrapeSchedule, lock_planes.in_set(FinishPhase::LockPlanes));
    }
}
