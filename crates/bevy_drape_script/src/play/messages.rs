//! Messages that the timeline sends.

use bevy::prelude::*;

use crate::checkpoint::Checkpoint;

/// Sent when the timeline asks for a picture.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct PictureDue {
    /// Name of the scene's camera that takes it.
    pub camera: String,
}

/// Sent when the timeline asks for a checkpoint: the state before the next step.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct CheckpointTaken {
    /// The name of the checkpoint.
    pub name: String,
    /// The state, with that of the timeline and the expectations.
    pub checkpoint: Checkpoint,
}
