//! Registers the descriptions that bodies are built from.

use bevy::prelude::*;
use drape_solver::{MeasuredFabric, Preset};

use crate::build::built::BodyBuilt;
use crate::build::cloth::Cloth;
use crate::build::description::{build_described, remove_described_body};
use crate::build::rigid_tetrahedron::{RigidTetrahedron, teleport_rigid_tetrahedra, write_rigid_tetrahedra};
use crate::build::rope::Rope;
use crate::build::soft_ball::SoftBall;
use crate::entity_events::trigger_written;
use crate::refusal::forget_removed;
use crate::schedule::{DrapeSchedule, FinishPhase, ScenePhase};

/// Cloths, ropes and soft balls.
pub(crate) struct DescriptionPlugin;

impl Plugin for DescriptionPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Cloth, Rope, SoftBall, Preset, MeasuredFabric, BodyBuilt)>()
            .add_message::<BodyBuilt>()
            .add_systems(DrapeSchedule, trigger_written::<BodyBuilt>.in_set(FinishPhase::TriggerObservers))
            .add_observer(remove_described_body::<Cloth>)
            .add_observer(remove_described_body::<Rope>)
            .add_observer(remove_described_body::<SoftBall>)
            .add_observer(forget_removed::<Cloth>)
            .add_observer(forget_removed::<Rope>)
            .add_observer(forget_removed::<SoftBall>)
            .add_systems(
                DrapeSchedule,
                (
                    build_described::<Cloth>.in_set(ScenePhase::BuildCloths),
                    build_described::<Rope>.in_set(ScenePhase::BuildRopes),
                    build_described::<SoftBall>.in_set(ScenePhase::BuildSoftBalls),
                ),
            );
    }
}

/// Rigid tetrahedra, whose transforms follow their particles.
pub(crate) struct RigidTetrahedronPlugin;

impl Plugin for RigidTetrahedronPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<RigidTetrahedron>()
            .add_observer(remove_described_body::<RigidTetrahedron>)
            .add_observer(forget_removed::<RigidTetrahedron>)
            .add_systems(
                DrapeSchedule,
                (
                    build_described::<RigidTetrahedron>.in_set(ScenePhase::BuildRigidTetrahedra),
                    teleport_rigid_tetrahedra.in_set(ScenePhase::TeleportRigidTetrahedra),
                    write_rigid_tetrahedra.in_set(FinishPhase::WriteRigidTetrahedra),
                ),
            );
    }
}
