//! Gives bodies their surfaces, and meshes to show them.

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoAutoAabb;
use bevy::prelude::*;

use crate::body::on_gpu::{AnyParts, OnGpu};
use crate::detail::level::CurrentDetail;
use crate::render::any_mesh::{AnyMesh, handle_of, insert_mesh};
use crate::render::attributes::{can_be_written, complete};
use crate::render::detail_mesh::{MeshesOfDetail, new_mesh};
use crate::render::shown::Shown;
use crate::render::surface::Surface;

/// Gives new and rebuilt cloths their surfaces, and meshes unless they have fitting ones.
pub(crate) fn build_surfaces<D: Shown>(
    mut commands: Commands,
    cloths: Query<(
        Entity,
        &D,
        AnyParts,
        Has<OnGpu>,
        &GlobalTransform,
        AnyMesh,
        Option<&Surface>,
        (Option<&CurrentDetail>, Option<&MeshesOfDetail>),
    )>,
    users: Query<(Entity, AnyMesh)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, cloth, parts, is_on_gpu, transform, mesh, surface, (detail, kept_meshes)) in &cloths {
        let Some((particles, topology)) = parts.get() else { continue };
        let is_flat = mesh.1.is_some();
        let mesh = handle_of(mesh);
        let is_known = surface.is_some_and(|surface| Arc::ptr_eq(&surface.topology, topology));
        let is_own = surface.zip(mesh).is_some_and(|(surface, mesh)| surface.mesh == mesh.id());
        if is_on_gpu && is_known && is_own {
            // The asset is not written from here.
            continue;
        }
        let asset = mesh.and_then(|mesh| meshes.get(mesh));
        let is_done = match (mesh, asset) {
            (Some(_), Some(asset)) => {
                let count = surface.map_or(particles.len(), Surface::vertex_count);
                is_known && is_own && can_be_written(asset, count)
            }
            // Not loaded yet.
            (Some(handle), None) => matches!(handle, Handle::Strong(_)),
            // The mesh was removed by hand.
            (None, _) => is_known,
        };
        if is_done {
            continue;
        }
        let full_layout = cloth.layout();
        let cloth = &*cloth.at(detail);
        if cloth.vertex_count() != particles.len() as u64 {
            // The cloth was changed after the step; the next one rebuilds it.
            continue;
        }
        if let (Some(surface), Some(mesh), Some(_)) = (surface, mesh, detail)
            && surface.layout != cloth.layout()
        {
            let mut kept = kept_meshes.cloned().unwrap_or_default();
            kept.keep(full_layout, surface.layout, mesh);
            let shown = kept.mesh(cloth, topology, &mut meshes);
            let mut surface = surface.resampled(particles, topology, cloth.layout());
            surface.mesh = shown.id();
            let mut entity = commands.entity(entity);
            entity.insert((surface, kept));
            insert_mesh(&mut entity, is_flat, shown);
            continue;
        }
        let fits_grid = surface.is_none_or(|surface| surface.layout == cloth.layout());
        let kept = asset.filter(|_| fits_grid).and_then(|asset| {
            let mut asset = asset.clone();
            complete(&mut asset, cloth, topology).then_some(asset)
        });
        if kept.is_none() && asset.is_some() && surface.is_none() {
            warn!("the mesh of cloth {entity} has not one vertex for each particle: it is replaced");
        }
        let is_shared =
            mesh.is_some() && users.iter().any(|(user, other)| user != entity && mesh == handle_of(other));
        let handle = mesh.filter(|_| kept.is_some() && !is_shared).cloned();

        let mut asset = kept.unwrap_or_else(|| new_mesh(cloth, topology, None));
        // Written here, read by the renderer.
        asset.asset_usage = RenderAssetUsages::MAIN_WORLD | RenderAssetUsages::RENDER_WORLD;
        let mut surface = Surface::new(particles, topology, cloth.layout());
        let bounds = surface.write_now(&mut asset, transform);
        let handle = put_asset(&mut meshes, handle, asset);
        surface.mesh = handle.id();
        let mut entity = commands.entity(entity);
        entity.insert((surface, NoAutoAabb, bounds.unwrap_or_default()));
        insert_mesh(&mut entity, is_flat, handle);
    }
}

/// Replaces the asset behind `handle`, or adds a new one.
fn put_asset(meshes: &mut Assets<Mesh>, handle: Option<Handle<Mesh>>, asset: Mesh) -> Handle<Mesh> {
    match handle {
        Some(handle) => {
            if let Some(mut known) = meshes.get_mut(&handle) {
                *known = asset;
            }
            handle
        }
        None => meshes.add(asset),
    }
}
