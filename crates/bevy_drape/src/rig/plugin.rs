//! Registers hand-built rigs.

use bevy::prelude::*;

use crate::rig::compile::compile_rigs;
use crate::rig::components::{InRig, Particle, Rig, RigEdits, Stick};
use crate::rig::transforms::{follow_rig_transforms, write_rig_transforms};
use crate::schedule::{DrapeSchedule, FinishPhase, ScenePhase};

/// Rigs: bodies compiled from particle and stick entities.
pub(crate) struct RigPlugin;

impl Plugin for RigPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Particle, Stick, Rig, InRig)>().init_resource::<RigEdits>().add_systems(
            DrapeSchedule,
            (
                compile_rigs.in_set(ScenePhase::CompileRigs),
                follow_rig_transforms.in_set(ScenePhase::FollowRigTransforms),
                write_rig_transforms.in_set(FinishPhase::WriteRigs),
            ),
        );
    }
}
