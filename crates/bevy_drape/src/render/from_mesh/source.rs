//! Meshes that bodies are made from, and the copies that show them.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoAutoAabb;
use bevy::ecs::component::Mutable;
use bevy::ecs::system::SystemParam;
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use drape_solver::MeshError;
use thiserror::Error;

use crate::change_detection::collect_changed;
use crate::render::from_mesh::reading::{MeshFault, faces, positions};
use crate::render::surface::Surface;

/// The mesh that a body or an obstacle was made from, which stays unchanged, and the copy that is shown.
#[derive(Component, Clone, Debug)]
pub(crate) struct MeshSource {
    pub source: Handle<Mesh>,
    /// None if no body was ever made from it.
    pub shown: Option<AssetId<Mesh>>,
}

impl MeshSource {
    /// Returns the mesh that an entity was given: the source of the copy, if it shows one.
    pub fn of(given: &Mesh3d, made: Option<&Self>) -> Handle<Mesh> {
        match made {
            Some(made) if made.shown == Some(given.id()) => made.source.clone(),
            _ => given.0.clone(),
        }
    }

    /// The source of an entity whose mesh is refused. It may still show an older copy.
    pub fn refused(given: &Mesh3d, made: Option<&Self>) -> Self {
        let shown = made.and_then(|made| made.shown).filter(|&shown| shown == given.id());
        Self { source: Self::of(given, made), shown }
    }
}

/// Marks each `D` as changed if its mesh has changed since the last run. It runs in every tick: Bevy drops messages
/// after two, and a game may be paused for longer.
pub(crate) fn mark_modified<D: Component<Mutability = Mutable>>(
    mut changes: MessageReader<AssetEvent<Mesh>>,
    mut made: Query<(&MeshSource, &mut D)>,
    mut modified: Local<Vec<AssetId<Mesh>>>,
) {
    // Most of these are shown copies, which are written each frame.
    modified.clear();
    modified.extend(changes.read().filter_map(|change| match change {
        AssetEvent::Modified { id } => Some(*id),
        _ => None,
    }));
    modified.sort_unstable();
    if modified.is_empty() {
        return;
    }
    for (mesh, mut description) in &mut made {
        if modified.binary_search(&mesh.source.id()).is_ok() {
            description.set_changed();
        }
    }
}

/// Entities whose `D` or mesh has changed.
#[derive(SystemParam)]
pub(crate) struct ChangedMeshes<'w, 's, D: Component> {
    components: Query<'w, 's, (Entity, Ref<'static, D>)>,
    given: Query<'w, 's, (Entity, Ref<'static, Mesh3d>), With<D>>,
    made: Query<'w, 's, (Entity, &'static MeshSource), With<D>>,
    swapped: Local<'s, Vec<Entity>>,
}

impl<D: Component> ChangedMeshes<'_, '_, D> {
    /// Appends to `found` the entities whose component was inserted, changed or [marked](mark_modified) since the last
    /// step, and those with another mesh.
    pub fn collect(&mut self, found: &mut Vec<Entity>) {
        collect_changed(&self.components, found);
        collect_changed(&self.given, &mut self.swapped);
        found.extend(self.swapped.drain(..).filter(|&entity| {
            let shown = self.made.get(entity).ok().and_then(|(_, mesh)| mesh.shown);
            self.given.get(entity).is_ok_and(|(_, mesh)| Some(mesh.id()) != shown)
        }));
    }
}

/// The parts of a mesh.
pub(crate) struct MeshParts<'a> {
    /// Positions in the mesh's coordinates.
    pub positions: &'a [[f32; 3]],
    /// One normal for each position, if the mesh has normals.
    pub normals: Option<&'a [[f32; 3]]>,
    pub faces: Vec<[u32; 3]>,
}

impl<'a> MeshParts<'a> {
    /// Reads the parts of `mesh`.
    ///
    /// # Errors
    /// [`MeshFault`] naming the missing part.
    pub fn of(mesh: &'a Mesh) -> Result<Self, MeshFault> {
        let positions = positions(mesh)?;
        let normals = mesh.try_attribute_option(Mesh::ATTRIBUTE_NORMAL).ok().flatten();
        let normals = normals
            .and_then(VertexAttributeValues::as_float3)
            .filter(|normals| normals.len() == positions.len());
        Ok(Self { positions, normals, faces: faces(mesh, positions.len())? })
    }

    /// Checks that the corners of all faces exist.
    ///
    /// # Errors
    /// [`MeshError::NoSuchVertex`] with the first that does not.
    pub fn check_faces(&self) -> Result<(), MeshError> {
        let count = self.positions.len();
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= count) {
                return Err(MeshError::NoSuchVertex { face, vertex, count });
            }
        }
        Ok(())
    }

    /// Copies the mesh to be written each frame: a triangle list with normals, and without a skin.
    pub fn copy_to_show(&self, mesh: &Mesh) -> Mesh {
        let mut copy = if mesh.primitive_topology() == PrimitiveTopology::TriangleList {
            mesh.clone()
        } else {
            list_of_triangles(mesh, &self.faces)
        };
        copy.remove_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
        copy.remove_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
        if self.normals.is_none() {
            copy.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; self.positions.len()]);
        }
        // Written here, read by the renderer.
        copy.asset_usage = RenderAssetUsages::MAIN_WORLD | RenderAssetUsages::RENDER_WORLD;
        copy
    }
}

/// Shows the copy of a mesh, which `surface` keeps up to date, instead of the mesh that the entity was given.
pub(crate) fn show_copy(
    entity: &mut EntityCommands,
    meshes: &mut Assets<Mesh>,
    transform: &GlobalTransform,
    source: Handle<Mesh>,
    mut surface: Surface,
    mut copy: Mesh,
) {
    let bounds = surface.write_now(&mut copy, transform);
    let shown = meshes.add(copy);
    surface.mesh = shown.id();
    let state = MeshSource { source, shown: Some(shown.id()) };
    entity.insert((Mesh3d(shown), state, surface, NoAutoAabb, bounds.unwrap_or_default()));
}

/// Converts a strip into a list, which can be torn.
fn list_of_triangles(strip: &Mesh, faces: &[[u32; 3]]) -> Mesh {
    let mut list = Mesh::new(PrimitiveTopology::TriangleList, strip.asset_usage);
    for (&attribute, values) in strip.attributes() {
        list.insert_attribute(attribute, values.clone());
    }
    list.with_inserted_indices(Indices::U32(faces.as_flattened().to_vec()))
}

/// A mesh that no body can be made from.
#[derive(Debug, Error)]
#[error("{mesh}: {fault}")]
pub(crate) struct FaultyMesh {
    mesh: String,
    #[source]
    fault: MeshFault,
}

impl FaultyMesh {
    pub fn new(mesh: &Handle<Mesh>, fault: MeshFault) -> Self {
        Self { mesh: called(mesh), fault }
    }
}

/// Names a mesh by the path that it was loaded from.
pub(crate) fn called(mesh: &Handle<Mesh>) -> String {
    mesh.path().map_or_else(|| "a mesh made in code".into(), |path| format!("mesh “{path}”"))
}
