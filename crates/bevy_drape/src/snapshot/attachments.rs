//! Tied particles.

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::attach::attachment::Attachment;
use crate::attach::attachment_state::{AttachmentState, HeldParticle};

/// The tied particles of one body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct AttachmentSnapshot {
    poses: Vec<Option<[f32; 12]>>,
    held: Vec<HeldParticle>,
}

pub(super) fn take(entity: EntityRef) -> Option<AttachmentSnapshot> {
    let state = entity.get::<AttachmentState>().filter(|_| entity.contains::<Attachment>())?;
    let poses = state.poses.iter().map(|pose| pose.map(|pose| pose.to_cols_array()));
    Some(AttachmentSnapshot { poses: poses.collect(), held: state.held.clone() })
}

/// Restores the tied particles of the entity's own [`Attachment`]. If that has other ties, all are made anew.
pub(super) fn restore(snapshot: Option<&AttachmentSnapshot>, body: u64, entity: &mut EntityWorldMut) {
    let Some(attachment) = entity.get::<Attachment>().cloned() else { return };
    let known = snapshot.filter(|snapshot| snapshot.poses.len() == attachment.ties.len());
    let state = known.map_or_else(AttachmentState::default, |snapshot| AttachmentState {
        made_of: attachment,
        body,
        poses: snapshot.poses.iter().map(|pose| pose.map(|pose| Affine3A::from_cols_array(&pose))).collect(),
        held: snapshot.held.clone(),
    });
    entity.insert(state);
}
