//! Registers tears and cuts.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

use crate::body::tearable::Tearable;
use crate::entity_events::trigger_written;
use crate::pending_messages::{Pending, collect_pending};
use crate::refusal::forget_removed;
use crate::schedule::{CollectRequests, DrapeSchedule, FinishPhase, ScenePhase};
use crate::tear::messages::{BodySplit, CutCloth, StickTorn};
use crate::tear::tearing::{cut_bodies, tear_bodies};

/// Bodies that tear, and blades that cut them.
pub(crate) struct TearPlugin {
    /// The schedule that takes steps.
    pub schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for TearPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Tearable, CutCloth, StickTorn, BodySplit)>()
            .init_resource::<Pending<CutCloth>>()
            .add_message::<BodySplit>()
            .add_message::<CutCloth>()
            .add_message::<StickTorn>()
            .add_observer(forget_removed::<Tearable>)
            .add_systems(self.schedule, collect_pending::<CutCloth>.in_set(CollectRequests))
            .add_systems(
                DrapeSchedule,
                (
                    collect_pending::<CutCloth>.in_set(ScenePhase::CollectCuts),
                    cut_bodies.in_set(ScenePhase::CutBodies),
                    tear_bodies.in_set(FinishPhase::TearBodies),
                    trigger_written::<StickTorn>.in_set(FinishPhase::TriggerObservers),
                ),
            );
    }
}
