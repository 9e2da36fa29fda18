//! The plugin that plays scenes.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeSchedule;

use super::messages::{CheckpointTaken, PictureDue};
use super::step;

/// Plays scripted scenes in an app that has [`DrapePlugins`] in their usual schedule. [`begin_scene`](super::begin_scene)
/// begins one.
///
/// ```text
/// FixedUpdate                  events that are due, keyframes, drags
///     (FixedPostUpdate)        DrapeSchedule takes a step; commands to bodies that have just been built are carried out
/// FixedLast                    hits are counted, expectations and triggers evaluated; the scene ends after its last step
/// ```
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<PictureDue>()
            .add_message::<CheckpointTaken>()
            .add_systems(FixedUpdate, step::before_step)
            .add_systems(DrapeSchedule, step::command_built_bodies.in_set(DrapeSystems::AccumulateForces))
            .add_systems(FixedLast, step::after_step);
    }
}
