//! The plugin.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeSchedule;

use crate::load::{Load, note_carriers, note_loads, wake_carried, wake_released};
use crate::marks::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};
use crate::motion::{EngineBody, hand_back, plan, start};
use crate::near::{Surroundings, look_around, note_disabled, note_enabled, switch_obstacles};
use crate::outdated::Outdated;
use crate::systems::BridgeSystems;

/// Runs what all bridges share. The bridge orders [`BridgeSystems::Start`] before the step of its engine, in `schedule`.
#[derive(Clone, Copy, Debug)]
pub struct BridgePlugin {
    /// The schedule of the engine's step.
    pub schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for BridgePlugin {
    fn build(&self, app: &mut App) {
        use BridgeSystems::{
            FindNear, HandBack, NoteChanges, Plan, ReadColliders, ReadEnds, ReadStarts, Start, Write,
        };
        app.init_resource::<Outdated>()
            .init_resource::<Surroundings>()
            .register_type::<(NoObstacle, ColliderObstacle, ObstacleOf, BodyObstacle)>()
            .register_required_components::<ObstacleOf, EngineBody>()
            .register_required_components::<ObstacleOf, Load>()
            .add_observer(note_disabled)
            .add_observer(note_enabled)
            .add_observer(wake_carried)
            .add_observer(wake_released)
            .configure_sets(self.schedule, (ReadStarts, Start).chain())
            .add_systems(self.schedule, start.in_set(Start))
            .configure_sets(
                DrapeSchedule,
                (
                    (NoteChanges, ReadColliders).chain().before(DrapeSystems::ManageScene),
                    (FindNear, ReadEnds, Plan).chain().in_set(DrapeSystems::PlaceObstacles),
                    (HandBack, Write).chain().after(DrapeSystems::Finish),
                ),
            )
            .add_systems(
                DrapeSchedule,
                (
                    look_around.in_set(DrapeSystems::PlaceObstacles).before(FindNear),
                    switch_obstacles.after(FindNear).before(ReadEnds),
                    plan.in_set(Plan),
                    (hand_back, note_carriers, note_loads).chain().in_set(HandBack),
                ),
            );
    }
}
