//! Poses of animations and references that bodies follow.

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::world_motion::WorldMotionState;

/// Poses of the joints, and of the reference of a `WorldMotion`, in the last step.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct MotionSnapshot {
    joints: Vec<[f32; 12]>,
    reference: Option<[f32; 12]>,
}

pub(super) fn take(entity: EntityRef) -> MotionSnapshot {
    let joints = entity.get::<AnimatedPose>().into_iter().flat_map(|pose| &pose.last);
    let reference = entity.get::<WorldMotionState>().and_then(|state| state.last);
    MotionSnapshot {
        joints: joints.map(Affine3A::to_cols_array).collect(),
        reference: reference.map(|reference| reference.to_cols_array()),
    }
}

pub(super) fn restore(snapshot: &MotionSnapshot, entity: &mut EntityWorldMut) {
    if let Some(mut pose) = entity.get_mut::<AnimatedPose>() {
        // With another skeleton the pose is computed anew.
        pose.last = snapshot.joints.iter().map(Affine3A::from_cols_array).collect();
        pose.shown = [None; 2];
    }
    if let Some(mut state) = entity.get_mut::<WorldMotionState>() {
        state.last = snapshot.reference.map(|reference| Affine3A::from_cols_array(&reference));
    }
}
