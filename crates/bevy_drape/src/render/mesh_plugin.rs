//! Meshes of cloths: made when the cloth is built, kept up with it afterwards.
//!
//! Each frame the vertices are put between the last two steps, so that motion is smooth at any frame rate, with
//! smooth normals and bounds of their own. The attributes are written in place: nothing is allocated here once a
//! mesh exists. A cloth at rest is not written, and so not uploaded, at all. Cloth has two sides: give it a
//! material that is `double_sided` and has no `cull_mode`.
//!
//! A mesh that is there already is kept if it has one vertex for each particle, in the particles' order: texture
//! coordinates, colours and indices may be your own. One that several entities share is copied first.

use std::sync::Arc;

use bevy::asset::{AssetEventSystems, RenderAssetUsages};
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, VisibilitySystems};
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

use crate::attach::animated_pose::AnimatedPose;
use crate::ball::projectile::build_projectiles;
use crate::body::particles::{Particles, Sticks};
use crate::build::cloth::Cloth;
use crate::build::description::remove_described_body;
use crate::build::soft_ball::SoftBall;
use crate::detail::level::CurrentDetail;
use crate::refusal::forget_removed;
use crate::render::detail_mesh::{MeshesOfDetail, new_mesh};
use crate::render::from_mesh::body::{build_mesh_bodies, remove_mesh_body};
use crate::render::from_mesh::cloth_mesh::{ClothMesh, WeldedVertices};
use crate::render::from_mesh::driven_mesh::{
    DrivenMesh, build_driven_meshes, hide_driven, record_driven_surfaces, remove_driven_mesh,
};
use crate::render::from_mesh::soft_body::SoftBody;
use crate::render::from_mesh::source::mark_modified;
use crate::render::rope_mesh::{RopeMesh, RopeSurface, build_rope_meshes, record_ropes, write_ropes};
use crate::render::surface::{EntitySpace, Shown, Surface, can_be_written, complete};
use crate::render::torn_mesh::tear_meshes;
use crate::render::visibility::hide_culled;
use crate::rig::compile::compile_rigs;
use crate::schedule::{DrapeSchedule, DrapeSystems};
use crate::step::run::run_drape_schedule;
use crate::transform::interpolation::step_fraction;

/// Gives each [`Cloth`] and [`SoftBall`] a [`Mesh3d`] and keeps it up with the simulation. To see it, add a `MeshMaterial3d`.
/// One that has a [`Mesh2d`] keeps that up instead, for a camera of two dimensions: spawn it with `Mesh2d::default()` and a
/// `MeshMaterial2d`.
///
/// Does nothing in an app without `Assets<Mesh>`.
#[derive(Clone, Copy, Debug)]
pub struct MeshPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl MeshPlugin {
    /// For steps taken in `schedule`. Vertices are interpolated where that is a schedule of the fixed loop;
    /// elsewhere the state after the last step is shown.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Plugin for MeshPlugin {
    fn build(&self, app: &mut App) {
        let fixed: [Interned<dyn ScheduleLabel>; 5] = [
            FixedFirst.intern(),
            FixedPreUpdate.intern(),
            FixedUpdate.intern(),
            FixedPostUpdate.intern(),
            FixedLast.intern(),
        ];
        app.register_type::<(ClothMesh, WeldedVertices, RopeMesh, SoftBody, DrivenMesh)>()
            .add_observer(remove_described_body::<ClothMesh>)
            .add_observer(remove_described_body::<SoftBody>)
            .add_observer(remove_mesh_body::<ClothMesh>)
            .add_observer(remove_mesh_body::<SoftBody>)
            .add_observer(remove_driven_mesh)
            .add_observer(forget_removed::<ClothMesh>)
            .add_observer(forget_removed::<SoftBody>)
            .add_observer(forget_removed::<DrivenMesh>);
        app.insert_resource(InterpolateSurfaces(fixed.contains(&self.schedule)));
        app.add_systems(
            self.schedule,
            (mark_modified::<ClothMesh>, mark_modified::<SoftBody>, mark_modified::<DrivenMesh>)
                .run_if(resource_exists::<Messages<AssetEvent<Mesh>>>)
                .before(run_drape_schedule),
        );
        app.add_systems(
            DrapeSchedule,
            (build_mesh_bodies::<ClothMesh>, build_mesh_bodies::<SoftBody>)
                .chain()
                .run_if(resource_exists::<Assets<Mesh>>)
                .in_set(DrapeSystems::ManageScene)
                .after(build_projectiles)
                .before(compile_rigs),
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
                write_surfaces
                    .run_if(resource_exists::<Assets<Mesh>>)
                    .after(TransformSystems::Propagate)
                    .before(AssetEventSystems)
                    .before(VisibilitySystems::CalculateBounds),
                (hide_culled, hide_driven).chain().before(VisibilitySystems::VisibilityPropagate),
            ),
        );
    }
}

/// Whether the time between two steps is known, so that what lies between them can be shown.
#[derive(Resource, Clone, Copy, Debug)]
struct InterpolateSurfaces(bool);

/// The mesh of an entity, in three dimensions or in two.
type AnyMesh = (Option<&'static Mesh3d>, Option<&'static Mesh2d>);

/// Its handle. One of two dimensions goes before.
fn handle_of<'a>((solid, flat): (Option<&'a Mesh3d>, Option<&'a Mesh2d>)) -> Option<&'a Handle<Mesh>> {
    flat.map(|mesh| &mesh.0).or(solid.map(|mesh| &mesh.0))
}

/// Gives new and rebuilt cloths their surface, and a mesh where there is none that fits.
fn build_surfaces<D: Shown>(
    mut commands: Commands,
    cloths: Query<(
        Entity,
        &D,
        &Particles,
        &Sticks,
        &GlobalTransform,
        AnyMesh,
        Option<&Surface>,
        (Option<&CurrentDetail>, Option<&MeshesOfDetail>),
    )>,
    users: Query<(Entity, AnyMesh)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, cloth, particles, sticks, transform, mesh, surface, (detail, kept_meshes)) in &cloths {
        let is_flat = mesh.1.is_some();
        let mesh = handle_of(mesh);
        let asset = mesh.and_then(|mesh| meshes.get(mesh));
        let is_known = surface.is_some_and(|surface| Arc::ptr_eq(&surface.topology, &sticks.0));
        match (mesh, asset) {
            (Some(mesh), Some(asset)) => {
                let is_own = surface.is_some_and(|surface| surface.mesh == mesh.id());
                if is_known && is_own && can_be_written(asset, particles.len()) {
                    continue;
                }
            }
            // Not loaded yet.
            (Some(Handle::Strong(_)), None) => continue,
            // Somebody took the mesh away, and so it shall be.
            (None, _) if is_known => continue,
            _ => {}
        }
        let full_layout = cloth.layout();
        let cloth = &*cloth.at(detail);
        if cloth.vertex_count() != particles.len() as u64 {
            // The cloth was changed after the step; the next one builds it anew.
            continue;
        }
        if let (Some(surface), Some(mesh), Some(_)) = (surface, mesh, detail)
            && surface.layout != cloth.layout()
        {
            let mut kept = kept_meshes.cloned().unwrap_or_default();
            kept.keep(full_layout, surface.layout, mesh);
            let shown = kept.mesh(cloth, &sticks.0, &mut meshes);
            let mut surface = surface.resampled(particles, &sticks.0, cloth.layout());
            surface.mesh = shown.id();
            let mut entity = commands.entity(entity);
            entity.insert((surface, kept));
            if is_flat {
                entity.insert(Mesh2d(shown));
            } else {
                entity.insert(Mesh3d(shown));
            }
            continue;
        }
        let fits_grid = surface.is_none_or(|surface| surface.layout == cloth.layout());
        let kept = asset.filter(|_| fits_grid).and_then(|asset| {
            let mut asset = asset.clone();
            complete(&mut asset, cloth, &sticks.0).then_some(asset)
        });
        if kept.is_none() && asset.is_some() && surface.is_none() {
            warn!("the mesh of cloth {entity} has not one vertex for each particle: it is replaced");
        }
        let is_shared =
            users.iter().any(|(user, other)| user != entity && mesh.is_some() && mesh == handle_of(other));
        let handle = mesh.filter(|_| kept.is_some() && !is_shared).cloned();

        let mut asset = kept.unwrap_or_else(|| new_mesh(cloth, &sticks.0, None));
        // Written here, read by the renderer.
        asset.asset_usage = RenderAssetUsages::MAIN_WORLD | RenderAssetUsages::RENDER_WORLD;
        let mut surface = Surface::new(particles, &sticks.0, cloth.layout());
        let bounds = EntitySpace::new(transform).and_then(|space| surface.write(&mut asset, &space, 1.0));
        let handle = match handle {
            Some(handle) => {
                if let Some(mut known) = meshes.get_mut(&handle) {
                    *known = asset;
                }
                handle
            }
            None => meshes.add(asset),
        };
        surface.mesh = handle.id();
        let mut entity = commands.entity(entity);
        entity.insert((surface, NoAutoAabb, bounds.unwrap_or_default()));
        if is_flat {
            entity.insert(Mesh2d(handle));
        } else {
            entity.insert(Mesh3d(handle));
        }
    }
}

/// Notes where the step left each cloth. Those that were not stepped have nothing to be shown in between.
fn record_surfaces(mut surfaces: Query<(Ref<Particles>, &mut Surface, Option<&mut AnimatedPose>)>) {
    for (particles, mut surface, posed) in &mut surfaces {
        if let Some(mut posed) = posed {
            posed.record();
        }
        if particles.is_changed() {
            surface.record(&particles);
        } else {
            surface.settle();
        }
    }
}

/// Writes what is to be shown now into the meshes of the cloths that have moved.
fn write_surfaces(
    mut surfaces: Query<
        (Entity, &mut Surface, AnyMesh, &GlobalTransform, Option<&mut Aabb>, Option<&DrivenMesh>),
        (Or<(With<Particles>, With<DrivenMesh>)>, Without<RopeSurface>),
    >,
    poses: Query<&AnimatedPose>,
    mut ropes: Query<(&mut RopeSurface, &Mesh3d, &GlobalTransform, &mut Aabb)>,
    places: Query<&GlobalTransform>,
    mut meshes: ResMut<Assets<Mesh>>,
    interpolate: Res<InterpolateSurfaces>,
    time: Option<Res<Time<Fixed>>>,
) {
    let fraction = if interpolate.0 { step_fraction(time.as_deref()) } else { 1.0 };
    write_ropes(&mut ropes, &mut meshes, fraction);
    for (entity, mut surface, mesh, transform, aabb, driven) in &mut surfaces {
        let Some(mesh) = handle_of(mesh) else { continue };
        let posed = poses.get(driven.map_or(entity, |driven| driven.driver)).ok();
        let ahead = posed.and_then(|posed| posed.ahead(fraction, |joint| places.get(joint).ok()));
        // Shown from where the character was in the steps that are shown, a cloth is where the character is now.
        let from = ahead.map(|ahead| GlobalTransform::from(ahead.inverse() * transform.affine()));
        let Some(space) = EntitySpace::new(from.as_ref().unwrap_or(transform)) else {
            continue;
        };
        if !surface.must_be_written(&space, fraction) || surface.mesh != mesh.id() {
            continue;
        }
        let Some(mut asset) = meshes.get_mut(mesh) else {
            continue;
        };
        let bounds = surface.write(&mut asset, &space, fraction);
        if let (Some(bounds), Some(mut aabb)) = (bounds, aabb) {
            *aabb = bounds;
        }
    }
}
