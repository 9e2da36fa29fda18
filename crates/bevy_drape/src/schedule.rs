//! The schedule of a step.
//!
//! ```text
//! DrapeSchedule   ManageScene        obstacles, pins, new bodies, cuts; wake, cull
//!                 AccumulateForces   gravity, wind; your forces go here
//!                 FormIslands        what can touch is grouped; forces become accelerations
//!                 DetectCollisions   what could touch what in this step
//!                 Substeps           runs DrapeSubsteps:
//! DrapeSubsteps       Integrate          \
//!                     Relax               > x substeps
//!                     ProjectCollisions  /
//!                 Finish             rest and sleep, hits, transforms, tears, counts
//! ```
//!
//! While nobody has a system of their own from [`FormIslands`](DrapeSystems::FormIslands) to
//! [`Finish`](DrapeSystems::Finish), each island goes through all its stages in one go, on its own thread, within
//! `Finish`. As soon as somebody does, the stages are run one by one, and bodies and balls are in their components in
//! between; the substeps still in one go, unless somebody has a system in [`DrapeSubsteps`]. All ways run the same
//! functions in the same order and give the same bits.
//!
//! Both schedules run their systems one after another: they are many and short. The work is spread over threads by
//! island.

use std::time::{Duration, Instant};

use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;

use crate::clock::DrapeClock;
use crate::step::island_run::StepStage;
use crate::step::islands::Islands;
use crate::step::systems::{
    begin_islands, detect_collisions, finish_islands, run_substeps_of_islands, substep_stage,
};

/// The schedule of one step. Run by [`DrapePlugins`](crate::DrapePlugins) in `FixedPostUpdate`, or wherever they were told to.
#[derive(ScheduleLabel, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct DrapeSchedule;

/// The schedule of one substep. See the [module](self) for what adding systems to it means.
#[derive(ScheduleLabel, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct DrapeSubsteps;

/// The sets of a step, in their order. The last three belong to [`DrapeSubsteps`], the others to
/// [`DrapeSchedule`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DrapeSystems {
    /// New bodies are built, blades cut, obstacles and pins follow their transforms, cannons fire; bodies wake and are
    /// culled.
    ManageScene,
    /// Gravity and wind are read. Systems that add forces to [`Particles`](crate::body::particles::Particles) belong here.
    AccumulateForces,
    /// Bodies and balls that could touch are grouped into islands, and forces become accelerations.
    FormIslands,
    /// Lists what could touch what within the step.
    DetectCollisions,
    /// Runs [`DrapeSubsteps`].
    Substeps,
    /// Bodies at rest fall asleep; hits are reported; transforms are written; bodies tear.
    Finish,
    /// Particles and balls fly freely for one substep.
    Integrate,
    /// N iterations of contacts, sticks and tethers.
    Relax,
    /// Contacts have the last word; velocities follow; friction.
    ProjectCollisions,
}

/// How long the stages of the last step took.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct StepTimes {
    /// The whole step, by the clock on the wall.
    pub step: Duration,
    /// The search for what could touch what: [`DrapeSystems::DetectCollisions`]. Summed up over islands, so that it is
    /// more than by the clock on the wall where several threads are at work.
    pub detect_collisions: Duration,
    /// All substeps, summed up likewise.
    pub substeps: Duration,
}

/// The plugin's own systems in [`DrapeSubsteps`].
const SUBSTEP: [(StepStage, DrapeSystems); 3] = [
    (StepStage::Integrate, DrapeSystems::Integrate),
    (StepStage::Relax, DrapeSystems::Relax),
    (StepStage::ProjectCollisions, DrapeSystems::ProjectCollisions),
];

/// Takes a step, if the clock says so.
pub(crate) fn run_drape_schedule(world: &mut World) {
    let timestep = world.resource::<Time>().delta_secs();
    if !world.resource_mut::<DrapeClock>().begin_step(timestep) {
        return;
    }
    let start = Instant::now();
    world.schedule_scope(DrapeSchedule, |world, schedule| {
        // What is wrong with the schedule is told when it is run.
        let _ = schedule.initialize(world);
        let is_fused = !is_substep_hooked(world) && !is_hooked(schedule);
        world.resource_mut::<Islands>().is_fused = is_fused;
        schedule.run(world);
    });
    world.resource_mut::<StepTimes>().step = start.elapsed();
    world.resource_mut::<DrapeClock>().end_step();
}

/// Whether anybody else has a system where the islands are on their way.
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

/// Runs the substeps, one by one if somebody looks.
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

/// Gives both schedules their sets and systems.
pub(crate) fn configure(app: &mut App) {
    app.edit_schedule(DrapeSchedule, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
        schedule.configure_sets(
            (
                DrapeSystems::ManageScene,
                DrapeSystems::AccumulateForces,
                DrapeSystems::FormIslands,
                DrapeSystems::DetectCollisions,
                DrapeSystems::Substeps,
                DrapeSystems::Finish,
            )
                .chain(),
        );
        schedule.add_systems(run_substeps.in_set(DrapeSystems::Substeps));
    });
    app.edit_schedule(DrapeSubsteps, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
        schedule.configure_sets(
            (DrapeSystems::Integrate, DrapeSystems::Relax, DrapeSystems::ProjectCollisions).chain(),
        );
        for (stage, set) in SUBSTEP {
            let stage_system = (move || -> StepStage { stage }).pipe(substep_stage);
            schedule.add_systems(stage_system.in_set(set));
        }
    });
}
