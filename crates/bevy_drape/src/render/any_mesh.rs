//! Meshes in three dimensions or in two.

use bevy::prelude::*;

/// The mesh of an entity, in three dimensions or in two.
pub(crate) type AnyMesh = (Option<&'static Mesh3d>, Option<&'static Mesh2d>);

/// The handle of an entity's mesh. The flat mesh counts if there are both.
pub(crate) fn handle_of<'a>(
    (solid, flat): (Option<&'a Mesh3d>, Option<&'a Mesh2d>),
) -> Option<&'a Handle<Mesh>> {
    flat.map(|mesh| &mesh.0).or(solid.map(|mesh| &mesh.0))
}

/// Shows another mesh, as [`Mesh2d`] if `is_flat`, else as [`Mesh3d`].
pub(crate) fn insert_mesh(entity: &mut EntityCommands, is_flat: bool, mesh: Handle<Mesh>) {
    if is_flat {
        entity.insert(Mesh2d(mesh));
    } else {
        entity.insert(Mesh3d(mesh));
    }
}
