//! The systems that take the islands through a step.
//!
//! Each of them advances every island to its own stage. In a [fused](Islands::is_fused) step the first ones do nothing,
//! and the last one runs all stages.

use bevy::prelude::*;
use drape_solver::world::staged_island::StepStage;

use crate::schedule::StepTimes;
use crate::step::components::StepComponents;
use crate::step::islands::Islands;
use crate::step::motion_limits::MotionLimitCounts;

/// Checks the islands and adds up the forces on them. Invalid bodies and balls are left out.
pub(crate) fn begin_islands(mut islands: ResMut<Islands>, mut components: StepComponents) {
    if !islands.is_fused {
        components.advance(&mut islands, StepStage::DetectCollisions);
    }
}

/// Lists everything that could touch within the step.
pub(crate) fn detect_collisions(mut islands: ResMut<Islands>, mut components: StepComponents) {
    if !islands.is_fused {
        components.advance(&mut islands, StepStage::Integrate);
    }
}

/// Runs all substeps of all islands at once.
pub(crate) fn run_substeps_of_islands(mut islands: ResMut<Islands>, mut components: StepComponents) {
    components.advance(&mut islands, StepStage::Finish);
}

/// Runs one stage of one substep of all islands.
pub(crate) fn substep_stage(
    In(stage): In<StepStage>,
    mut islands: ResMut<Islands>,
    mut components: StepComponents,
) {
    components.run(&mut islands, |island, environment| island.run_substep_stage(environment, stage));
}

/// Runs the rest of the step, and records its times.
pub(crate) fn finish_islands(
    mut islands: ResMut<Islands>,
    mut components: StepComponents,
    mut times: ResMut<StepTimes>,
    mut limits: ResMut<MotionLimitCounts>,
) {
    components.advance(&mut islands, StepStage::Done);
    times.detect_collisions = islands.live().iter().map(|island| island.detect_time).sum();
    times.substeps = islands.live().iter().map(|island| island.substep_time).sum();
    let conflicts = islands.live().iter().map(|island| island.limit_conflicts).sum::<usize>();
    let total_conflicts = limits.total_conflicts + conflicts as u64;
    limits.set_if_neq(MotionLimitCounts { conflicts, total_conflicts });
}
