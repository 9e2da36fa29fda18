//! Meshes of cloths: created with the cloth, and updated with the simulation.
//!
//! Each frame interpolates the vertices between the last two steps, so that motion is smooth at any frame rate, and
//! computes smooth normals and bounds. Attributes are written in place: nothing is allocated once a mesh exists. What is
//! at rest, or outside of what cameras and lights see, is neither written nor uploaded; in an app without cameras all is written. Cloth has two sides: give it a material that is `double_sided` and
//! has no `cull_mode`.
//!
//! An existing mesh is kept if it has one vertex for each particle, in the particles' order: texture coordinates,
//! colours and indices may be your own. A mesh that several entities share is copied first.

use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::skinning::SkinnedMeshInverseBindposes;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

use crate::ball::projectile::build_projectiles;
use crate::body::tearable::RestoredMesh;
use crate::build::cloth::Cloth;
use crate::build::description::remove_described_body;
use crate::build::soft_ball::SoftBall;
use crate::environment::obstacle::Obstacle;
use crate::refusal::forget_removed;
use crate::render::build_surfaces::build_surfaces;
use crate::render::from_mesh::body::{build_mesh_bodies, remove_mesh_body};
use crate::render::from_mesh::body_colliders::{BodyCollider, BodyColliders, BodyCollidersReport};
use crate::render::from_mesh::cloth_mesh::{ClothMesh, WeldedVertices};
use crate::render::from_mesh::driven_mesh::{
    DrivenMesh, build_driven_meshes, hide_driven, record_driven_surfaces, remove_driven_mesh,
};
use crate::render::from_mesh::obstacle_hierarchy::{
    ObstacleHierarchy, make_obstacles, remove_made_obstacles,
};
use crate::render::from_mesh::obstacle_mesh::{remove_obstacle_mesh, shape_obstacles};
use crate::render::from_mesh::soft_body::SoftBodyMesh;
use crate::render::from_mesh::source::mark_modified;
use crate::render::from_mesh::spawn_colliders::{remove_body_colliders, spawn_body_colliders};
use crate::render::mesh_times::MeshTimes;
use crate::render::rope_mesh::{RopeMesh, build_rope_meshes, record_ropes};
use crate::render::torn_mesh::{restore_meshes, tear_meshes};
use crate::render::visibility::hide_culled;
use crate::render::write_surfaces::{record_surfaces, write_surfaces};
use crate::rig::compile::compile_rigs;
use crate::schedule::{DrapeSchedule, DrapeSystems, ScenePhase};
use crate::step::run::run_drape_schedule;

/// Gives each [`Cloth`] and [`SoftBall`] a [`Mesh3d`] and updates it with the simulation. Add a `MeshMaterial3d` to see
/// it. For a 2D camera spawn it with `Mesh2d::default()` and a `MeshMaterial2d` instead: then the [`Mesh2d`] is
/// updated.
///
/// Does nothing in an app without `Assets<Mesh>`.
#[derive(Clone, Copy, Debug)]
pub struct MeshPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl MeshPlugin {
    /// For steps taken in `schedule`. In a schedule of the fixed loop vertices are interpolated; elsewhere they show
    /// the last step.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Plugin for MeshPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(ClothMesh, WeldedVertices, RopeMesh, SoftBodyMesh, DrivenMesh, ObstacleHierarchy)>()
            .register_type::<(BodyColliders, BodyCollider, BodyCollidersReport, MeshTimes)>()
            .init_resource::<MeshTimes>()
            .add_observer(remove_described_body::<ClothMesh>)
            .add_observer(remove_described_body::<SoftBodyMesh>)
            .add_observer(remove_mesh_body::<ClothMesh>)
            .add_observer(remove_mesh_body::<SoftBodyMesh>)
            .add_observer(remove_driven_mesh)
            .add_observer(remove_obstacle_mesh)
            .add_observer(remove_made_obstacles)
            .add_observer(remove_body_colliders)
            .add_observer(forget_removed::<BodyColliders>)
            .add_observer(forget_removed::<ClothMesh>)
            .add_observer(forget_removed::<SoftBodyMesh>)
            .add_observer(forget_removed::<DrivenMesh>);
        app.add_systems(
            self.schedule,
            (
                mark_modified::<ClothMesh>,
                mark_modified::<SoftBodyMesh>,
                mark_modified::<DrivenMesh>,
                mark_modified::<Obstacle>,
            )
                .run_if(resource_exists::<Messages<AssetEvent<Mesh>>>)
                .before(run_drape_schedule),
        );
        app.add_systems(
            self.schedule,
            restore_meshes
                .run_if(any_with_component::<RestoredMesh>)
                .run_if(resource_exists::<Assets<Mesh>>)
                .before(run_drape_schedule),
        );
        app.add_systems(
            DrapeSchedule,
            (build_mesh_bodies::<ClothMesh>, build_mesh_bodies::<SoftBodyMesh>)
                .chain()
                .run_if(resource_exists::<Assets<Mesh>>)
                .in_set(DrapeSystems::ManageScene)
                .after(build_projectiles)
                .before(compile_rigs),
        );
        app.add_systems(
            DrapeSchedule,
            (
                make_obstacles.run_if(any_with_component::<ObstacleHierarchy>),
                shape_obstacles.run_if(resource_exists::<Assets<Mesh>>),
            )
                .chain()
                .in_set(DrapeSystems::ManageScene)
                .after(ScenePhase::InheritMotion)
                .before(ScenePhase::SyncObstacles),
        );
        app.add_systems(
            self.schedule,
            (
                (
                    tear_meshes,
                    build_surfaces::<Cloth>,
                    build_surfaces::<SoftBall>,
                    build_rope_meshes,
                    build_driven_meshes,
                )
                    .chain()
                    .run_if(resource_exists::<Assets<Mesh>>),
                (record_surfaces, record_driven_surfaces, record_ropes),
            )
                .chain()
                .after(run_drape_schedule)
                .before(TransformSystems::Propagate),
        );
        app.add_systems(
            PostUpdate,
            (
                // Before the capsules are placed for the first time.
                spawn_body_colliders
                    .run_if(any_with_component::<BodyColliders>)
                    .run_if(resource_exists::<Assets<Mesh>>)
                    .run_if(resource_exists::<Assets<SkinnedMeshInverseBindposes>>)
                    .before(TransformSystems::Propagate),
                write_surfaces
                    .run_if(resource_exists::<Assets<Mesh>>)
                    .after(TransformSystems::Propagate)
                    .after(VisibilitySystems::UpdateFrusta)
                    // What was visible in the last frame is known until then.
                    .before(VisibilitySystems::VisibilityPropagate)
                    .before(AssetEventSystems)
                    .before(VisibilitySystems::CalculateBounds),
                (hide_culled, hide_driven).chain().before(VisibilitySystems::VisibilityPropagate),
            ),
        );
    }
}
