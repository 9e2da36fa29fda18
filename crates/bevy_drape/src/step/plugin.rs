//! Registers the step itself.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

use crate::schedule::{
    CollectRequests, DrapeSchedule, DrapeStep, DrapeSystems, FinishPhase, StepTimes, configure_schedules,
};
use crate::step::advance::{begin_islands, detect_collisions, finish_islands};
use crate::step::components::forget_mended;
use crate::step::form_islands::form_islands;
use crate::step::islands::Islands;
use crate::step::motion_limits::MotionLimitCounts;
use crate::step::run::{add_substeps, run_drape_schedule};

/// The schedules of step and substep, and the islands that go through them.
pub(crate) struct StepPlugin {
    /// The schedule that takes steps.
    pub schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for StepPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(StepTimes, MotionLimitCounts)>()
            .init_resource::<Islands>()
            .init_resource::<MotionLimitCounts>()
            .init_resource::<StepTimes>();
        configure_schedules(app);
        add_substeps(app);
        app.configure_sets(
            self.schedule,
            CollectRequests.before(run_drape_schedule).before(TransformSystems::Propagate),
        )
        .add_systems(self.schedule, run_drape_schedule.in_set(DrapeStep).before(TransformSystems::Propagate))
        .add_systems(
            DrapeSchedule,
            (
                (form_islands, begin_islands).chain().in_set(DrapeSystems::FormIslands),
                detect_collisions.in_set(DrapeSystems::DetectCollisions),
                (finish_islands, forget_mended).chain().in_set(FinishPhase::FinishIslands),
            ),
        );
    }
}
