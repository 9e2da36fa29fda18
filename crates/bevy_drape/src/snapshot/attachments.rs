//! Tied particles.

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::attach::attachment::{Attachment, TiedParticles};
use crate::attach::attachment_state::{AttachmentState, HeldParticle};

/// The tied particles of one body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct AttachmentSnapshot {
    /// The particles of each tie.
    ties: Vec<TiedParticles>,
    poses: Vec<Option<[f32; 12]>>,
    held: Vec<HeldParticle>,
}

pub(super) fn take(entity: EntityRef) -> Option<AttachmentSnapshot> {
    let (attachment, state) = (entity.get::<Attachment>()?, entity.get::<AttachmentState>()?);
    let ties = attachment.ties.iter().map(|tie| tie.particles.clone());
    let poses = state.poses.iter().map(|pose| pose.map(|pose| pose.to_cols_array()));
    Some(AttachmentSnapshot { ties: ties.collect(), poses: poses.collect(), held: state.held.clone() })
}

/// Restores the tied particles of the entity's own [`Attachment`]. If that has other ties, all are made anew. `has_torn` is true if the
/// body has been torn, or made whole, so that the ties hold others of its particles.
pub(super) fn restore(
    snapshot: Option<&AttachmentSnapshot>,
    body: u64,
    has_torn: bool,
    entity: &mut EntityWorldMut,
) {
    let Some(mut attachment) = entity.get::<Attachment>().cloned() else { return };
    let known = snapshot.filter(|snapshot| snapshot.poses.len() == attachment.ties.len());
    if let Some(snapshot) = known.filter(|_| has_torn) {
        for (tie, particles) in attachment.ties.iter_mut().zip(&snapshot.ties) {
            tie.particles.clone_from(particles);
        }
        entity.insert(attachment.clone());
    }
    let state = known.map_or_else(AttachmentState::default, |snapshot| AttachmentState {
        made_of: attachment,
        body,
        poses: snapshot.poses.iter().map(|pose| pose.map(|pose| Affine3A::from_cols_array(&pose))).collect(),
        held: snapshot.held.clone(),
    });
    entity.insert(state);
}
