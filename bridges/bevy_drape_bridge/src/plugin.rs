//! The plugin.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeSchedule;

use crate::load::{Load, note_loads, wake_carried};
use crate::marks::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};
use crate::motion::{EngineBody, hand_back, plan, start};
use crate::outdated::Outdated;

/// The systems of a bridge, in the order of a step. An engine's own systems are those that read and write.
///
/// ```text
/// engine's schedule   ReadStarts -> Start -> (the engine takes its step)
/// DrapeSchedule       ReadColliders -> ReadEnds -> Plan -> (cloth takes its step) -> HandBack -> Write
/// ```
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BridgeSystems {
    /// The engine's bodies are read into [`EngineBody`](crate::EngineBody), before its step.
    ReadStarts,
    /// Obstacles go where their bodies begin the step.
    Start,
    /// Obstacles of colliders and of bodies are brought up to date.
    ReadColliders,
    /// The engine's bodies are read again, after its step.
    ReadEnds,
    /// Obstacles learn where the engine has brought their bodies.
    Plan,
    /// Cloth has taken its step: bodies that it pushed learn where they are.
    HandBack,
    /// Bodies that were pushed are written back to the engine.
    Write,
}

/// Runs what all bridges share. The bridge orders [`BridgeSystems::Start`] before the step of its engine, in `schedule`.
#[derive(Clone, Copy, Debug)]
pub struct BridgePlugin {
    /// The schedule of the engine's step.
    pub schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for BridgePlugin {
    fn build(&self, app: &mut App) {
        use BridgeSystems::{HandBack, Plan, ReadColliders, ReadEnds, ReadStarts, Start, Write};
        app.init_resource::<Outdated>()
            .register_type::<(NoObstacle, ColliderObstacle, ObstacleOf, BodyObstacle)>()
            .register_required_components::<ObstacleOf, EngineBody>()
            .register_required_components::<ObstacleOf, Load>()
            .add_observer(wake_carried)
            .configure_sets(self.schedule, (ReadStarts, Start).chain())
            .add_systems(self.schedule, start.in_set(Start))
            .configure_sets(
                DrapeSchedule,
                (
                    (ReadColliders, ReadEnds, Plan).chain().before(DrapeSystems::ManageScene),
                    (HandBack, Write).chain().after(DrapeSystems::Finish),
                ),
            )
            .add_systems(
                DrapeSchedule,
                (plan.in_set(Plan), (hand_back, note_loads).chain().in_set(HandBack)),
            );
    }
}
