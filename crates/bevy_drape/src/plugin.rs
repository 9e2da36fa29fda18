//! The plugins.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! // A fast game on a server: sixty steps a second, no window, no meshes.
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()));
//! app.insert_resource(Time::<Fixed>::from_hz(60.0));
//! let curtain = app.world_mut().spawn(Cloth::new(2.0, 1.5)).id();
//! app.update();
//! assert!(app.world().get::<Cloth>(curtain).is_some());
//! ```

use bevy::app::{PluginGroup, PluginGroupBuilder};
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

use crate::attach::plugin::{
    AttachmentPlugin, FollowParticlePlugin, GrabPlugin, PlaneLockPlugin, WinchPlugin, WorldMotionPlugin,
};
use crate::ball::plugin::{BallPlugin, CannonPlugin};
use crate::body::plugin::{BodyPlugin, PressurePlugin};
use crate::bones::plugin::BonePlugin;
use crate::build::plugin::{DescriptionPlugin, RigidTetrahedronPlugin};
use crate::contact::plugin::{ContactEventsPlugin, HitPlugin, ReactionPlugin};
use crate::detail::plugin::LevelOfDetailPlugin;
use crate::environment::plugin::{DynamicObstaclePlugin, ObstaclePlugin, WindPlugin};
use crate::rig::plugin::RigPlugin;
use crate::sleep::plugin::SleepPlugin;
use crate::step::plugin::StepPlugin;
use crate::tear::plugin::TearPlugin;
use crate::transform::interpolation::{InterpolationPlugin, ShowsBetweenSteps};
use crate::transform::moved_by_frame::MovedByFramePlugin;
use crate::transform::plugin::PropagationPlugin;

/// All plugins of bevy_drape. Add them, spawn a [`Cloth`](crate::build::cloth::Cloth), done.
///
/// ```no_run
/// use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
///
/// App::new()
///     .add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
///     .add_systems(Startup, |mut commands: Commands| {
///         commands.spawn(Cloth::new(2.0, 1.5));
///     })
///     .run();
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DrapePlugins {
    schedule: Interned<dyn ScheduleLabel>,
}

impl DrapePlugins {
    /// Takes a step in each run of `schedule`, as long as the delta of the schedule's `Time`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Default for DrapePlugins {
    /// Takes steps in `FixedPostUpdate`: at the fixed rate, after the game's own logic.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

impl PluginGroup for DrapePlugins {
    fn build(self) -> PluginGroupBuilder {
        let plugins = PluginGroupBuilder::start::<Self>()
            .add(SolverPlugin { schedule: self.schedule })
            .add(InterpolationPlugin)
            .add(MovedByFramePlugin);
        #[cfg(feature = "mesh")]
        let plugins = plugins.add(crate::render::plugin::MeshPlugin::new(self.schedule));
        #[cfg(feature = "gltf")]
        let plugins = plugins.add(crate::bones::vrm::VrmPlugin);
        #[cfg(feature = "gpu")]
        let plugins = plugins.add(crate::gpu::GpuPlugin::new(self.schedule));
        #[cfg(feature = "picking")]
        let plugins = plugins.add(crate::tools::picking::DrapePickingPlugin);
        #[cfg(feature = "gizmos")]
        let plugins = plugins.add(crate::tools::gizmos::GizmosPlugin);
        plugins
    }
}

/// The simulation: bodies, balls, obstacles, and the schedule that steps them.
#[derive(Clone, Copy, Debug)]
pub struct SolverPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for SolverPlugin {
    /// Adds the features, roughly in the order of a step. [`schedule`](crate::schedule) orders their systems.
    fn build(&self, app: &mut App) {
        let schedule = self.schedule;
        app.insert_resource(ShowsBetweenSteps::of(schedule))
            .add_plugins((BodyPlugin, StepPlugin { schedule }, PropagationPlugin))
            .add_plugins((CannonPlugin { schedule }, DescriptionPlugin, RigidTetrahedronPlugin, BallPlugin))
            .add_plugins((
                RigPlugin,
                TearPlugin { schedule },
                LevelOfDetailPlugin,
                WorldMotionPlugin,
                BonePlugin { schedule },
            ))
            .add_plugins((WindPlugin, ObstaclePlugin, DynamicObstaclePlugin))
            .add_plugins((AttachmentPlugin, WinchPlugin, GrabPlugin, PressurePlugin, SleepPlugin))
            .add_plugins((
                HitPlugin,
                PlaneLockPlugin,
                ReactionPlugin,
                ContactEventsPlugin,
                FollowParticlePlugin,
            ));
    }
}
