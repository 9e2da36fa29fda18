//! Registers cloths and springs of bones.

use bevy::app::AnimationSystems;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

use crate::bones::bone_cloth::{BoneCloth, BoneWeave};
use crate::bones::build::{build_bone_cloths, remove_bone_cloth};
use crate::bones::show::{ShownBones, record_bones, restore_bones, restore_lost_bones, show_bones};
use crate::bones::spring_bones::{SpringBones, SpringCollider, SpringJoint};
use crate::bones::springs::{prepare_springs, remove_springs, swing_springs};
use crate::build::description::remove_described_body;
use crate::refusal::forget_removed;
use crate::schedule::{DrapeSchedule, DrapeStep, DrapeSystems, FinishPhase, ScenePhase};
use crate::step::run::run_drape_schedule;

/// The sets of the systems that write joints of [`BoneCloth`] and [`SpringBones`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BoneSystems {
    /// In `First`: joints get their animated transforms back.
    Restore,
    /// In `PostUpdate`, after animations: joints turn as they have been solved. Pose the rest of the character before.
    Show,
}

/// Joints that are solved as ropes and cloth, or swing by VRM's equations.
pub(crate) struct BonePlugin {
    /// The schedule of the steps.
    pub schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for BonePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(BoneCloth, BoneWeave, SpringBones, SpringJoint, SpringCollider)>()
            .add_observer(remove_described_body::<BoneCloth>)
            .add_observer(remove_bone_cloth)
            .add_observer(remove_springs)
            .add_observer(restore_lost_bones)
            .add_observer(forget_removed::<BoneCloth>)
            .add_observer(forget_removed::<SpringBones>)
            .configure_sets(
                PostUpdate,
                BoneSystems::Show
                    .after(AnimationSystems)
                    .after(DrapeStep)
                    .before(TransformSystems::Propagate)
                    .run_if(any_with_component::<ShownBones>),
            )
            .configure_sets(First, BoneSystems::Restore.run_if(any_with_component::<ShownBones>))
            .add_systems(First, restore_bones.in_set(BoneSystems::Restore))
            .add_systems(self.schedule, record_bones.after(run_drape_schedule).before(BoneSystems::Show))
            .add_systems(
                DrapeSchedule,
                (
                    restore_bones
                        .run_if(any_with_component::<ShownBones>)
                        .in_set(DrapeSystems::ManageScene)
                        .before(ScenePhase::PropagateTransforms),
                    (build_bone_cloths, prepare_springs).chain().in_set(ScenePhase::BuildBoneCloths),
                    swing_springs.in_set(FinishPhase::SwingSprings),
                ),
            )
            .add_systems(PostUpdate, show_bones.in_set(BoneSystems::Show));
    }
}
