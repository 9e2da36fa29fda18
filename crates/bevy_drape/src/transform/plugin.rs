//! Registers the propagation of transforms within the fixed loop.

use bevy::prelude::*;
use bevy::transform::systems::{
    StaticTransformOptimizations, mark_dirty_trees, propagate_parent_transforms, sync_simple_transforms,
};

use crate::schedule::{DrapeSchedule, ScenePhase};
use crate::transform::propagation::{have_hierarchies_moved, have_roots_moved};

/// Global transforms that are up to date at the start of a step. Bevy updates them after the fixed loop only: too late.
pub(crate) struct PropagationPlugin;

impl Plugin for PropagationPlugin {
    fn build(&self, app: &mut App) {
        // In case the app has no `TransformPlugin`.
        app.init_resource::<StaticTransformOptimizations>().add_systems(
            DrapeSchedule,
            (
                (mark_dirty_trees, propagate_parent_transforms).chain().run_if(have_hierarchies_moved),
                sync_simple_transforms.run_if(have_roots_moved),
            )
                .chain()
                .in_set(ScenePhase::PropagateTransforms),
        );
    }
}
