//! Registers gravity, wind and obstacles.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;

use crate::body::contact_events::ContactEvents;
use crate::body::layers::DrapeLayers;
use crate::environment::dynamic_obstacle::{DynamicObstacle, ObstacleReaction, PlannedPlacement};
use crate::environment::fly_obstacles::fly_dynamic_obstacles;
use crate::environment::gravity::DrapeGravity;
use crate::environment::moved_by_obstacle::MovedByObstacle;
use crate::environment::obstacle::{Obstacle, TeleportObstacle};
use crate::environment::obstacle_changes::{
    ObstacleChanges, note_disabled_obstacle, note_gone_obstacle, recheck_obstacle,
};
use crate::environment::obstacle_shape::ShapeFromMesh;
use crate::environment::solver_environment::{SolverEnvironment, read_environment};
use crate::environment::sync_obstacles::sync_obstacles;
use crate::environment::wake_regions::WakeRegions;
use crate::environment::wind::{Gusts, Wind};
use crate::environment::wind_zone::{WindFlow, WindRegion, WindZone};
use crate::refusal::forget_removed;
use crate::schedule::{DrapeSchedule, DrapeSystems, ScenePhase};

/// Gravity, and the wind everywhere and in zones.
pub(crate) struct WindPlugin;

impl Plugin for WindPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(DrapeGravity, Wind, Gusts, WindZone, WindRegion, WindFlow)>()
            .init_resource::<DrapeGravity>()
            .init_resource::<SolverEnvironment>()
            .init_resource::<Wind>()
            .add_observer(forget_removed::<WindZone>)
            .add_systems(DrapeSchedule, read_environment.in_set(DrapeSystems::AccumulateForces));
    }
}

/// Obstacles that nothing pushes back.
pub(crate) struct ObstaclePlugin;

impl Plugin for ObstaclePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Obstacle, ShapeFromMesh, TeleportObstacle)>()
            .init_resource::<ObstacleChanges>()
            .init_resource::<WakeRegions>()
            .add_observer(note_gone_obstacle)
            .add_observer(note_disabled_obstacle)
            .add_observer(recheck_obstacle::<Remove<Disabled>>)
            .add_observer(recheck_obstacle::<Add<ContactEvents>>)
            .add_observer(recheck_obstacle::<Remove<ContactEvents>>)
            .add_observer(recheck_obstacle::<Add<TeleportObstacle>>)
            .add_observer(recheck_obstacle::<Remove<DrapeLayers>>)
            .add_observer(recheck_obstacle::<Insert<ShapeFromMesh>>)
            .add_observer(recheck_obstacle::<Remove<ShapeFromMesh>>)
            .add_observer(forget_removed::<Obstacle>)
            .add_systems(DrapeSchedule, sync_obstacles.in_set(ScenePhase::SyncObstacles));
    }
}

/// Obstacles that fly, or ask for reactions.
pub(crate) struct DynamicObstaclePlugin;

impl Plugin for DynamicObstaclePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(DynamicObstacle, ObstacleReaction, PlannedPlacement, MovedByObstacle)>()
            .add_observer(recheck_obstacle::<Add<ObstacleReaction>>)
            .add_observer(recheck_obstacle::<Remove<ObstacleReaction>>)
            .add_observer(recheck_obstacle::<Remove<DynamicObstacle>>)
            .add_observer(forget_removed::<DynamicObstacle>)
            .add_systems(DrapeSchedule, fly_dynamic_obstacles.in_set(ScenePhase::FlyDynamicObstacles));
    }
}
