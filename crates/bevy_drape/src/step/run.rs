//! Runs the schedule of a step, and that of its substeps.

use bevy::platform::time::Instant;
use bevy::prelude::*;
use drape_solver::world::staged_island::StepStage;

use crate::clock::DrapeClock;
use crate::schedule::{DrapeSchedule, DrapeSubsteps, DrapeSystems, StepTimes};
use crate::step::advance::{
    begin_islands, detect_collisions, finish_islands, run_substeps_of_islands, substep_stage,
};
use crate::step::islands::Islands;

/// The plugin's own systems in [`DrapeSubsteps`].
const SUBSTEP: [(StepStage, DrapeSystems); 3] = [
    (StepStage::Integrate, DrapeSystems::Integrate),
    (StepStage::Relax, DrapeSystems::Relax),
    (StepStage::ProjectCollisions, DrapeSystems::ProjectCollisions),
];

/// Takes a step, if one is due.
pub(crate) fn run_drape_schedule(world: &mut World) {
    let timestep = world.resource::<Time>().delta_secs();
    if !world.resource_mut::<DrapeClock>().begin_step(timestep) {
        return;
    }
    let start = Instant::now();
    world.schedule_scope(DrapeSchedule, |world, schedule| {
        // Errors of the schedule are reported when it runs.
        let _ = schedule.initialize(world);
        let is_fused = !is_substep_hooked(world) && !is_hooked(schedule);
        world.resource_mut::<Islands>().is_fused = is_fused;
        schedule.run(world);
    });
    world.resource_mut::<StepTimes>().step = start.elapsed();
    world.resource_mut::<DrapeClock>().end_step();
}

/// True if user systems run between the first and the last stage of the islands.
fn is_hooked(schedule: &Schedule) -> bool {
    let Ok(systems) = schedule.systems() else { return true };
    let first = begin_islands.system_type_id();
    let last = finish_islands.system_type_id();
    let own = [
        first,
        detect_collisions.system_type_id(),
        run_substeps.system_type_id(),
        ApplyDeferred.system_type_id(),
    ];
    let order = systems.map(|(_, system)| system.system_type());
    let mut on_their_way = order.skip_while(|system| *system != first).take_while(|system| *system != last);
    on_their_way.any(|system| !own.contains(&system))
}

fn is_substep_hooked(world: &World) -> bool {
    let systems = world.resource::<Schedules>().get(DrapeSubsteps).map_or(0, Schedule::systems_len);
    systems != SUBSTEP.len()
}

/// Runs the substeps, one by one if there are user systems among them.
pub(crate) fn run_substeps(world: &mut World) {
    if is_substep_hooked(world) {
        for _ in 0..world.resource::<Islands>().substeps() {
            world.run_schedule(DrapeSubsteps);
        }
    } else if !world.resource::<Islands>().is_fused {
        // The system is cached by its type: nothing is allocated from the second step on.
        let _ = world.run_system_cached(run_substeps_of_islands);
    }
}

/// Adds the substeps to both schedules.
pub(crate) fn add_substeps(app: &mut App) {
    app.add_systems(DrapeSchedule, run_substeps.in_set(DrapeSystems::Substeps));
    for (stage, set) in SUBSTEP {
        let stage_system = (move || -> StepStage { stage }).pipe(substep_stage);
        app.add_systems(DrapeSubsteps, stage_system.in_set(set));
    }
}
