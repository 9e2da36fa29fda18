//! Registers sleeping, waking and culling.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;

use crate::body::fabric::Fabric;
use crate::body::layers::DrapeLayers;
use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::body::tearable::Tearable;
use crate::entity_events::trigger_written;
use crate::schedule::{DrapeSchedule, FinishPhase, ScenePhase};
use crate::sleep::activity_counts::{ActivityCounts, count_activity};
use crate::sleep::candidates::{
    Candidates, collect_candidates, note_gone_ball, note_gone_body, note_lost_component,
};
use crate::sleep::cull::cull;
use crate::sleep::fall_asleep::fall_asleep;
use crate::sleep::messages::{BodySlept, BodyWoken, Sleepers, forget_sleeper, report_sleep};
use crate::sleep::move_obstacles::{Reached, move_obstacles, note_reached};
use crate::sleep::scene_manager::SceneManager;
use crate::sleep::waking::wake;
use crate::viewer::Viewer;

/// The scene manager.
pub(crate) struct SleepPlugin;

impl Plugin for SleepPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(SceneManager, Viewer, ActivityCounts, BodySlept, BodyWoken)>()
            .add_message::<BodySlept>()
            .add_message::<BodyWoken>()
            .init_resource::<Sleepers>()
            .add_observer(forget_sleeper)
            .init_resource::<ActivityCounts>()
            .init_resource::<Candidates>()
            .init_resource::<Reached>()
            .init_resource::<SceneManager>()
            .add_observer(note_gone_body)
            .add_observer(note_gone_ball)
            .add_observer(note_lost_component::<Fabric>)
            .add_observer(note_lost_component::<BodySurface>)
            .add_observer(note_lost_component::<SolverSettings>)
            .add_observer(note_lost_component::<DrapeLayers>)
            .add_observer(note_lost_component::<Tearable>)
            .add_observer(note_lost_component::<Disabled>)
            .add_systems(
                DrapeSchedule,
                (
                    (note_reached, move_obstacles).chain().in_set(ScenePhase::MoveObstacles),
                    (collect_candidates, wake, cull).chain().in_set(ScenePhase::WakeAndCull),
                    fall_asleep.in_set(FinishPhase::FallAsleep),
                    (report_sleep, count_activity).chain().in_set(FinishPhase::CountActivity),
                    (trigger_written::<BodySlept>, trigger_written::<BodyWoken>)
                        .chain()
                        .in_set(FinishPhase::TriggerObservers),
                ),
            );
    }
}
