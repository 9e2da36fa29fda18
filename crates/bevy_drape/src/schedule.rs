//! The schedule of a step.
//!
//! ```text
//! DrapeSchedule   ManageScene        obstacles, pins, new bodies; wake, cull
//!                 AccumulateForces   gravity, wind; your forces go here
//!                 FormIslands        what can touch is grouped; forces become accelerations
//!                 DetectCollisions   what could touch what in this step
//!                 Substeps           runs DrapeSubsteps:
//! DrapeSubsteps       Integrate          \
//!                     Relax               > x substeps
//!                     ProjectCollisions  /
//!                 Finish             rest and sleep, hits, transforms, counts
//! ```
//!
//! While nobody has a system of their own in [`DrapeSubsteps`], each island runs its substeps in one go, on its
//! own thread. As soon as somebody does, the schedule is run substep by substep. Both ways run the same functions
//! in the same order and give the same bits.

use std::time::{Duration, Instant};

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

use crate::clock::DrapeClock;
use crate::islands::{Islands, SUBSTEP, SubstepStage, run_fused_substeps, substep_stage};

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
    /// New bodies are built, obstacles and pins follow their transforms, cannons fire; bodies wake and are
    /// culled.
    ManageScene,
    /// Gravity and wind are read. Systems that add forces to [`Particles`](crate::particles::Particles) belong here.
    AccumulateForces,
    /// Bodies and balls that could touch are grouped into islands, and forces become accelerations.
    FormIslands,
    /// Lists what could touch what within the step.
    DetectCollisions,
    /// Runs [`DrapeSubsteps`].
    Substeps,
    /// Bodies at rest fall asleep; hits are reported; transforms are written.
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
    /// The whole step.
    pub step: Duration,
    /// The search for what could touch what: [`DrapeSystems::DetectCollisions`].
    pub detect_collisions: Duration,
    /// All substeps.
    pub substeps: Duration,
}

/// Number of systems that the plugin itself has in [`DrapeSubsteps`].
const OWN_SUBSTEP_SYSTEMS: usize = SUBSTEP.len();

/// Takes a step, if the clock says so.
pub(crate) fn run_drape_schedule(world: &mut World) {
    let timestep = world.resource::<Time>().delta_secs();
    if !world.resource_mut::<DrapeClock>().begin_step(timestep) {
        return;
    }
    let start = Instant::now();
    world.run_schedule(DrapeSchedule);
    world.resource_mut::<StepTimes>().step = start.elapsed();
    world.resource_mut::<DrapeClock>().end_step();
}

/// Runs the substeps: fused if nobody looks, else one by one.
pub(crate) fn run_substeps(world: &mut World) {
    let start = Instant::now();
    let systems = world.resource::<Schedules>().get(DrapeSubsteps).map_or(0, Schedule::systems_len);
    if systems == OWN_SUBSTEP_SYSTEMS {
        // The system is cached by its type: nothing is allocated from the second step on.
        let _ = world.run_system_cached(run_fused_substeps);
    } else {
        for _ in 0..world.resource::<Islands>().substeps() {
            world.run_schedule(DrapeSubsteps);
        }
    }
    world.resource_mut::<StepTimes>().substeps = start.elapsed();
}

/// Gives both schedules their sets and systems.
pub(crate) fn configure(app: &mut App) {
    app.edit_schedule(DrapeSchedule, |schedule| {
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
        schedule.configure_sets(
            (DrapeSystems::Integrate, DrapeSystems::Relax, DrapeSystems::ProjectCollisions).chain(),
        );
        let sets = [DrapeSystems::Integrate, DrapeSystems::Relax, DrapeSystems::ProjectCollisions];
        for (stage, set) in SUBSTEP.into_iter().zip(sets) {
            let stage_system = (move || -> SubstepStage { stage }).pipe(substep_stage);
            schedule.add_systems(stage_system.in_set(set));
        }
    });
}
