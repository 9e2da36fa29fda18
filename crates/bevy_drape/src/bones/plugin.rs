//! Registers cloths and springs of bones.

use bevy::app::AnimationSystems;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

use crate::bones::bone_cloth::{BoneCloth, BoneWeave};
use crate::bones::build::{build_bone_cloths, remove_bone_cloth};
use crate::bones::show::{record_bones, restore_bones, restore_lost_bones, show_bones};
use crate::bones::spring_bones::{SpringBones, SpringCollider, SpringJoint};
use crate::bones::springs::{prepare_springs, remove_springs, swing_springs};
use crate::refusal::forget_removed;
use crate::schedule::{DrapeSchedule, FinishPhase, ScenePhase};

/// Joints that are solved as ropes and cloth, or swing by VRM's equations.
pub(crate) struct BonePlugin;

impl Plugin for BonePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(BoneCloth, BoneWeave, SpringBones, SpringJoint, SpringCollider)>()
            .add_observer(remove_bone_cloth)
            .add_observer(remove_springs)
            .add_observer(restore_lost_bones)
            .add_observer(forget_removed::<BoneCloth>)
            .add_observer(forget_removed::<SpringBones>)
            .add_systems(First, restore_bones)
            .add_systems(
                DrapeSchedule,
                (
                    (build_bone_cloths, prepare_springs).chain().in_set(ScenePhase::BuildBoneCloths),
                    (record_bones, swing_springs).chain().in_set(FinishPhase::RecordBones),
                ),
            )
            .add_systems(PostUpdate, show_bones.after(AnimationSystems).before(TransformSystems::Propagate));
    }
}
