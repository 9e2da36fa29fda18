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

use std::time::Duration;

use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;

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

/// The plugin's own systems in [`DrapeSystems::ManageScene`], one after another in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum ScenePhase {
    PropagateTransforms,
    CollectCuts,
    FireCannons,
    BuildCloths,
    BuildRopes,
    BuildRigidTetrahedra,
    BuildSoftBalls,
    BuildBalls,
    CompileRigs,
    CutBodies,
    ChooseDetail,
    InheritMotion,
    SyncObstacles,
    FlyDynamicObstacles,
    MovePins,
    MovePosed,
    MoveAttached,
    TeleportBalls,
    FollowRigTransforms,
    TeleportRigidTetrahedra,
    TurnWinches,
    PullGrabbed,
    WakePressed,
    WakeAndCull,
}

/// The plugin's own systems in [`DrapeSystems::Finish`], one after another in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum FinishPhase {
    FinishIslands,
    ReportHits,
    FallAsleep,
    LockPlanes,
    GiveReactions,
    SendContacts,
    WriteBalls,
    WriteRigs,
    FollowParticles,
    WriteRigidTetrahedra,
    TearBodies,
    CountActivity,
}

/// The systems that collect requests in each tick, also while the simulation is paused. They run before the step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CollectRequests;

/// Puts the sets of both schedules in order.
pub(crate) fn configure_schedules(app: &mut App) {
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
        configure_scene_phases(schedule);
        configure_finish_phases(schedule);
    });
    app.edit_schedule(DrapeSubsteps, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
        schedule.configure_sets(
            (DrapeSystems::Integrate, DrapeSystems::Relax, DrapeSystems::ProjectCollisions).chain(),
        );
    });
}

fn configure_scene_phases(schedule: &mut Schedule) {
    use ScenePhase as Phase;
    schedule.configure_sets(
        (
            (
                Phase::PropagateTransforms,
                Phase::CollectCuts,
                Phase::FireCannons,
                Phase::BuildCloths,
                Phase::BuildRopes,
                Phase::BuildRigidTetrahedra,
                Phase::BuildSoftBalls,
                Phase::BuildBalls,
                Phase::CompileRigs,
                Phase::CutBodies,
                Phase::ChooseDetail,
                Phase::InheritMotion,
            )
                .chain(),
            (
                Phase::SyncObstacles,
                Phase::FlyDynamicObstacles,
                Phase::MovePins,
                Phase::MovePosed,
                Phase::MoveAttached,
                Phase::TeleportBalls,
                Phase::FollowRigTransforms,
                Phase::TeleportRigidTetrahedra,
                Phase::TurnWinches,
                Phase::PullGrabbed,
                Phase::WakePressed,
                Phase::WakeAndCull,
            )
                .chain(),
        )
            .chain()
            .in_set(DrapeSystems::ManageScene),
    );
}

fn configure_finish_phases(schedule: &mut Schedule) {
    use FinishPhase as Phase;
    schedule.configure_sets(
        (
            Phase::FinishIslands,
            Phase::ReportHits,
            Phase::FallAsleep,
            Phase::LockPlanes,
            Phase::GiveReactions,
            Phase::SendContacts,
            Phase::WriteBalls,
            Phase::WriteRigs,
            Phase::FollowParticles,
            Phase::WriteRigidTetrahedra,
            Phase::TearBodies,
            Phase::CountActivity,
        )
            .chain()
            .in_set(DrapeSystems::Finish),
    );
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
