//! Meshes of a cloth at its levels of detail.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use drape_solver::Topology;

use crate::detail::resampling::resample;
use crate::render::attributes::complete;
use crate::render::shown::Shown;

/// Meshes of a cloth from other levels of detail, kept for the return to them.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct MeshesOfDetail {
    /// Columns and rows of the cloth in full detail.
    full: [u32; 2],
    /// Columns and rows of each, and its mesh.
    kept: Vec<([u32; 2], Handle<Mesh>)>,
}

impl MeshesOfDetail {
    /// Keeps the mesh of `layout`, of a cloth whose description has `full` columns and rows.
    pub fn keep(&mut self, full: [u32; 2], layout: [u32; 2], mesh: &Handle<Mesh>) {
        if self.full != full {
            // The description has changed.
            *self = Self { full, kept: Vec::new() };
        }
        self.kept.retain(|&(known, _)| known != layout);
        self.kept.push((layout, mesh.clone()));
    }

    /// Returns the mesh for `shown`: the kept one, else a new one with resampled texture coordinates of the full one.
    pub fn mesh(&self, shown: &impl Shown, topology: &Topology, meshes: &mut Assets<Mesh>) -> Handle<Mesh> {
        let of =
            |layout: [u32; 2]| self.kept.iter().find(|&&(known, _)| known == layout).map(|(_, mesh)| mesh);
        if let Some(mesh) = of(shown.layout())
            && meshes.get(mesh).is_some_and(|mesh| mesh.count_vertices() == topology.particle_count())
        {
            return mesh.clone();
        }
        let full = of(self.full).and_then(|mesh| meshes.get(mesh));
        let new = new_mesh(
            shown,
            topology,
            full.and_then(|mesh| texture_coordinates(mesh, self.full, shown.layout())),
        );
        meshes.add(new)
    }
}

/// Creates a mesh with a vertex for each particle. Positions are written later.
pub(crate) fn new_mesh(shown: &impl Shown, topology: &Topology, uvs: Option<Vec<[f32; 2]>>) -> Mesh {
    let mut new = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default());
    new.insert_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0_f32; 3]; topology.particle_count()]);
    if let Some(uvs) = uvs {
        new.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    }
    complete(&mut new, shown, topology);
    new
}

/// Resamples the texture coordinates of a grid of vertices; none if the mesh does not have one for each vertex.
fn texture_coordinates(mesh: &Mesh, from: [u32; 2], to: [u32; 2]) -> Option<Vec<[f32; 2]>> {
    let Some(VertexAttributeValues::Float32x2(values)) =
        mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_0).ok()?
    else {
        return None;
    };
    let values: Vec<Vec2> = values.iter().map(|&value| value.into()).collect();
    let fits = values.len() == from[0] as usize * from[1] as usize && from[0] > 1 && from[1] > 1;
    fits.then(|| resample(&values, from, to).into_iter().map(|uv| uv.to_array()).collect())
}
