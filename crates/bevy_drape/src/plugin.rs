//! The plugins.

use bevy::app::{PluginGroup, PluginGroupBuilder};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::transform::TransformSystems;
use bevy::transform::systems::{
    StaticTransformOptimizations, mark_dirty_trees, propagate_parent_transforms, sync_simple_transforms,
};

use crate::attach::attachment::{Attachment, Tie, TiedParticles};
use crate::attach::follow_attachment::{move_attached, release_attached};
use crate::attach::follow_particle::{FollowParticle, FollowedParticle, follow_particles};
use crate::attach::follow_pose::move_posed;
use crate::attach::grab::{Grab, Hand, pull_grabbed};
use crate::attach::pins::move_pins;
use crate::attach::plane_lock::{PlaneLock, lock_planes};
use crate::attach::winch::{Winch, turn_winches};
use crate::attach::world_motion::{TeleportCloth, WorldMotion, inherit_motion};
use crate::ball::cannon::{Cannon, CannonFired, FireCannon, fire_cannons};
use crate::ball::projectile::{
    Projectile, ProjectileState, build_projectiles, remove_ball, teleport_projectiles,
    write_projectile_transforms,
};
use crate::body::activity::Activity;
use crate::body::body_state::CreationOrder;
use crate::body::contact_events::ContactEvents;
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks, forget_despawned_body};
use crate::body::pressure::{Pressure, wake_pressed, wake_slack};
use crate::body::settings::{DefaultSolverSettings, Quality, SolverSettings};
use crate::body::tearable::Tearable;
use crate::build::cloth::Cloth;
use crate::build::description::{build_described, remove_described_body};
use crate::build::preset::Preset;
use crate::build::rigid_tetrahedron::{RigidTetrahedron, teleport_rigid_tetrahedra, write_rigid_tetrahedra};
use crate::build::rope::Rope;
use crate::build::soft_ball::SoftBall;
use crate::clock::DrapeClock;
use crate::contact::contact_pairs::ContactPairs;
use crate::contact::events::{
    ContactFeature, DrapeContact, DrapeContactCounts, DrapeContactEnded, DrapeContactHit,
    DrapeContactSettings, DrapeContactStarted,
};
use crate::contact::hit::{BallHit, Touching};
use crate::contact::reactions::give_reactions;
use crate::contact::report_hits::report_hits;
use crate::contact::send_contacts::send_contacts;
use crate::detail::change::{LostDetail, choose_detail, note_lost_detail};
use crate::detail::level::{CurrentDetail, LevelOfDetail};
use crate::environment::dynamic_obstacle::{DynamicObstacle, ObstacleReaction};
use crate::environment::fly_obstacles::fly_dynamic_obstacles;
use crate::environment::gravity::DrapeGravity;
use crate::environment::obstacle::{Obstacle, TeleportObstacle};
use crate::environment::obstacle_changes::{
    ObstacleChanges, note_disabled_obstacle, note_gone_obstacle, recheck_obstacle,
};
use crate::environment::solver_environment::{SolverEnvironment, read_environment};
use crate::environment::sync_obstacles::sync_obstacles;
use crate::environment::wake_regions::WakeRegions;
use crate::environment::wind::{Gusts, Wind};
use crate::environment::wind_zone::{WindFlow, WindRegion, WindZone};
use crate::pending_messages::{Pending, collect_pending};
use crate::refusal::{Refusals, forget_removed};
use crate::rig::compile::compile_rigs;
use crate::rig::components::{InRig, Particle, Rig, RigEdits, Stick};
use crate::rig::transforms::{follow_rig_transforms, write_rig_transforms};
use crate::schedule::{DrapeSchedule, DrapeSystems, StepTimes};
use crate::sleep::activity_counts::{ActivityCounts, count_activity};
use crate::sleep::candidates::{
    Candidates, collect_candidates, note_gone_ball, note_gone_body, note_lost_component,
};
use crate::sleep::cull::cull;
use crate::sleep::fall_asleep::fall_asleep;
use crate::sleep::scene_manager::SceneManager;
use crate::sleep::waking::wake;
use crate::step::advance::{begin_islands, detect_collisions, finish_islands};
use crate::step::form_islands::form_islands;
use crate::step::islands::Islands;
use crate::step::motion_limits::MotionLimitCounts;
use crate::step::run::{configure, run_drape_schedule};
use crate::tear::messages::{BodySplit, CutCloth, StickTorn};
use crate::tear::tearing::{cut_bodies, tear_bodies};
use crate::transform::interpolation::InterpolationPlugin;
use crate::transform::moved_by_frame::MovedByFramePlugin;
use crate::transform::propagation::{have_hierarchies_moved, have_unparented_moved};
use crate::viewer::Viewer;

/// All plugins of bevy_drape. Two lines to start: add these, spawn a [`Cloth`].
///
/// ```no_run
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
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
    /// Takes steps in `schedule`, as long as the time that the schedule's `Time` advances by.
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
        let plugins = plugins.add(crate::render::mesh_plugin::MeshPlugin::new(self.schedule));
        #[cfg(feature = "picking")]
        let plugins = plugins.add(crate::tools::picking::DrapePickingPlugin);
        #[cfg(feature = "gizmos")]
        let plugins = plugins.add(crate::tools::gizmos::GizmosPlugin);
        plugins
    }
}

/// Bodies, balls, obstacles, the scene manager and the schedule that steps them.
#[derive(Clone, Copy, Debug)]
pub struct SolverPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for SolverPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Activity, Cloth, Rope, Particles, Sticks, SolverSettings, Obstacle)>()
            .register_type::<(Projectile, ProjectileState, Cannon, Viewer, Quality)>()
            .register_type::<(DrapeClock, DrapeGravity, Wind, DefaultSolverSettings, SceneManager)>()
            .register_type::<(DynamicObstacle, ObstacleReaction, TeleportObstacle)>()
            .register_type::<(Particle, Stick, Rig, InRig, Grab, Hand)>()
            .register_type::<(ContactEvents, ContactFeature, DrapeContact, DrapeLayers)>()
            .register_type::<(DrapeContactStarted, DrapeContactHit, DrapeContactEnded)>()
            .register_type::<(DrapeContactSettings, DrapeContactCounts)>()
            .register_type::<(SoftBall, Pressure, RigidTetrahedron, Preset, Winch, PlaneLock)>()
            .register_type::<(LevelOfDetail, CurrentDetail)>()
            .register_type::<(WorldMotion, TeleportCloth, MotionLimitCounts)>()
            .register_type::<(Attachment, Tie, TiedParticles, FollowParticle, FollowedParticle)>()
            .register_type::<(Tearable, CutCloth, StickTorn, BodySplit)>()
            .register_type::<(Gusts, WindZone, WindRegion, WindFlow)>()
            .register_type::<(ActivityCounts, FireCannon, CannonFired, BallHit, StepTimes, Refusals)>();
        app.init_resource::<ActivityCounts>()
            .init_resource::<Candidates>()
            .init_resource::<ContactPairs>()
            .init_resource::<CreationOrder>()
            .init_resource::<DefaultSolverSettings>()
            .init_resource::<DrapeClock>()
            .init_resource::<DrapeContactCounts>()
            .init_resource::<DrapeContactSettings>()
            .init_resource::<DrapeGravity>()
            .init_resource::<Islands>()
            .init_resource::<LostDetail>()
            .init_resource::<MotionLimitCounts>()
            .init_resource::<ObstacleChanges>()
            .init_resource::<Pending<CutCloth>>()
            .init_resource::<Pending<FireCannon>>()
            .init_resource::<Refusals>()
            .init_resource::<RigEdits>()
            .init_resource::<SceneManager>()
            .init_resource::<SolverEnvironment>()
            // In case the app has no `TransformPlugin`.
            .init_resource::<StaticTransformOptimizations>()
            .init_resource::<StepTimes>()
            .init_resource::<WakeRegions>()
            .init_resource::<Touching>()
            .init_resource::<Wind>()
            .add_message::<BallHit>()
            .add_message::<BodySplit>()
            .add_message::<CannonFired>()
            .add_message::<CutCloth>()
            .add_message::<DrapeContactEnded>()
            .add_message::<DrapeContactHit>()
            .add_message::<DrapeContactStarted>()
            .add_message::<FireCannon>()
            .add_message::<StickTorn>();
        app.add_observer(remove_described_body::<Cloth>)
            .add_observer(remove_described_body::<Rope>)
            .add_observer(remove_described_body::<RigidTetrahedron>)
            .add_observer(remove_described_body::<SoftBall>)
            .add_observer(remove_ball)
            .add_observer(note_gone_body)
            .add_observer(note_gone_ball)
            .add_observer(note_lost_component::<SolverSettings>)
            .add_observer(note_lost_detail)
            .add_observer(forget_removed::<LevelOfDetail>)
            .add_observer(note_gone_obstacle)
            .add_observer(note_disabled_obstacle)
            .add_observer(recheck_obstacle::<Remove, Disabled>)
            .add_observer(recheck_obstacle::<Add, ContactEvents>)
            .add_observer(recheck_obstacle::<Add, ObstacleReaction>)
            .add_observer(recheck_obstacle::<Remove, ObstacleReaction>)
            .add_observer(recheck_obstacle::<Add, TeleportObstacle>)
            .add_observer(recheck_obstacle::<Remove, DynamicObstacle>)
            .add_observer(forget_removed::<DynamicObstacle>)
            .add_observer(recheck_obstacle::<Remove, ContactEvents>)
            .add_observer(recheck_obstacle::<Remove, DrapeLayers>)
            .add_observer(note_lost_component::<DrapeLayers>)
            .add_observer(forget_removed::<Cannon>)
            .add_observer(release_attached)
            .add_observer(wake_slack)
            .add_observer(forget_removed::<Attachment>)
            .add_observer(forget_removed::<Cloth>)
            .add_observer(forget_removed::<Obstacle>)
            .add_observer(forget_despawned_body)
            .add_observer(forget_removed::<Projectile>)
            .add_observer(forget_removed::<Rope>)
            .add_observer(forget_removed::<RigidTetrahedron>)
            .add_observer(forget_removed::<SoftBall>)
            .add_observer(forget_removed::<Tearable>)
            .add_observer(forget_removed::<Winch>)
            .add_observer(forget_removed::<WindZone>)
            .add_observer(forget_removed::<WorldMotion>);
        configure(app);
        app.add_systems(
            self.schedule,
            (collect_pending::<CutCloth>, collect_pending::<FireCannon>, run_drape_schedule)
                .chain()
                .before(TransformSystems::Propagate),
        );
        app.add_systems(
            DrapeSchedule,
            (
                (
                    // Bevy brings global transforms up to date after the fixed loop only: too late for a step.
                    (
                        (mark_dirty_trees, propagate_parent_transforms)
                            .chain()
                            .run_if(have_hierarchies_moved),
                        sync_simple_transforms.run_if(have_unparented_moved),
                    )
                        .chain(),
                    (collect_pending::<CutCloth>, collect_pending::<FireCannon>, fire_cannons).chain(),
                    (
                        build_described::<Cloth>,
                        build_described::<Rope>,
                        build_described::<RigidTetrahedron>,
                        build_described::<SoftBall>,
                        build_projectiles,
                    )
                        .chain(),
                    (compile_rigs, cut_bodies, choose_detail, inherit_motion).chain(),
                    (sync_obstacles, fly_dynamic_obstacles).chain(),
                    (
                        move_pins,
                        move_posed,
                        move_attached,
                        teleport_projectiles,
                        follow_rig_transforms,
                        teleport_rigid_tetrahedra,
                        turn_winches,
                        pull_grabbed,
                    )
                        .chain(),
                    (wake_pressed, collect_candidates, wake, cull).chain(),
                )
                    .chain()
                    .in_set(DrapeSystems::ManageScene),
                read_environment.in_set(DrapeSystems::AccumulateForces),
                (form_islands, begin_islands).chain().in_set(DrapeSystems::FormIslands),
                detect_collisions.in_set(DrapeSystems::DetectCollisions),
                (
                    finish_islands,
                    report_hits,
                    fall_asleep,
                    lock_planes,
                    give_reactions,
                    send_contacts,
                    write_projectile_transforms,
                    write_rig_transforms,
                    follow_particles,
                    write_rigid_tetrahedra,
                    tear_bodies,
                    count_activity,
                )
                    .chain()
                    .in_set(DrapeSystems::Finish),
            ),
        );
    }
}
