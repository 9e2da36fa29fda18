//! The schedule of a step: labels, sets and their order.
//!
//! ```text
//! DrapeSchedule   ManageScene        new bodies, cuts; obstacles, pins; wake, cull
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
//! Without user systems from [`FormIslands`](DrapeSystems::FormIslands) to [`Finish`](DrapeSystems::Finish), each
//! island runs through all its stages at once, on its own thread, within `Finish`. With user systems there the stages
//! run one by one, and bodies and balls are in their components in between. The substeps still run at once unless a
//! user system is in [`DrapeSubsteps`]. All ways run the same functions in the same order and give the same bits.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::schedule::DrapeSchedule;
//!
//! /// A magnet at the origin, for everything that is made of particles.
//! fn pull(mut bodies: Query<&mut Particles>) {
//!     for mut particles in &mut bodies {
//!         for i in 0..particles.len() {
//!             let force = -0.1 * particles.position(i);
//!             particles.add_force(i, force);
//!         }
//!     }
//! }
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()));
//! app.add_systems(DrapeSchedule, pull.in_set(DrapeSystems::AccumulateForces));
//! # app.update();
//! ```
//!
//! Both schedules run their many short systems on one thread. Islands spread the work over all threads.

use std::time::Duration;

use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;

/// The schedule of one step. [`DrapePlugins`](crate::DrapePlugins) run it in `FixedPostUpdate` or in the schedule of
/// your choice.
#[derive(ScheduleLabel, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct DrapeSchedule;

/// The schedule of one substep. Adding systems to it changes the way that steps run: see the [module](self).
#[derive(ScheduleLabel, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct DrapeSubsteps;

/// The set of the system that runs [`DrapeSchedule`], in `FixedPostUpdate` or the schedule of your choice. Order it after
/// whatever moves obstacles there.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::schedule::DrapeStep;
/// # #[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)] struct MyPhysics;
/// # let mut app = App::new();
/// app.configure_sets(FixedPostUpdate, DrapeStep.after(MyPhysics));
/// ```
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DrapeStep;

/// The sets of a step, in their order. The last three belong to [`DrapeSubsteps`], the others to
/// [`DrapeSchedule`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DrapeSystems {
    /// Builds new bodies, cuts, fires cannons, moves obstacles and pins with their transforms, wakes and culls bodies.
    ManageScene,
    /// A part of [`ManageScene`](Self::ManageScene), after new bodies are built and before obstacles are read: for systems that place
    /// obstacles by the bodies of the step.
    PlaceObstacles,
    /// Reads gravity and wind. Systems that add forces to [`Particles`](crate::body::particles::Particles) belong here.
    AccumulateForces,
    /// Groups bodies and balls that could touch into islands, and turns forces into accelerations.
    FormIslands,
    /// Lists everything that could touch within the step.
    DetectCollisions,
    /// Runs [`DrapeSubsteps`].
    Substeps,
    /// Puts resting bodies to sleep, reports hits and contacts, writes transforms, tears bodies.
    Finish,
    /// Moves particles and balls freely for one substep.
    Integrate,
    /// Relaxes contacts, sticks and tethers, for a number of iterations.
    Relax,
    /// Projects contacts last, updates velocities, and applies friction.
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
    BuildBoneCloths,
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
    MoveObstacles,
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
    SwingSprings,
    WriteRigidTetrahedra,
    TearBodies,
    CountActivity,
    TriggerObservers,
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
                Phase::BuildBoneCloths,
                Phase::BuildBalls,
                Phase::CompileRigs,
                Phase::CutBodies,
                Phase::ChooseDetail,
                Phase::InheritMotion,
            )
                .chain(),
            DrapeSystems::PlaceObstacles,
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
                Phase::MoveObstacles,
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
            Phase::SwingSprings,
            Phase::WriteRigidTetrahedra,
            Phase::TearBodies,
            Phase::CountActivity,
            Phase::TriggerObservers,
        )
            .chain()
            .in_set(DrapeSystems::Finish),
    );
}

/// Times of the stages of the last step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct StepTimes {
    /// Wall time of the whole step.
    pub step: Duration,
    /// Time of [`DrapeSystems::DetectCollisions`], added up over islands: more than wall time if several threads work.
    pub detect_collisions: Duration,
    /// Time of all substeps, added up over islands.
    pub substeps: Duration,
}
