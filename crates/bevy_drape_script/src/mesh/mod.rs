//! Triangle meshes: read from glTF files or generated.
//!
//! Imports `text` for suggestions in errors. `scene` builds bodies of the meshes, `load` fills [`MeshFiles`].

mod gltf;
mod icosphere;
mod mesh_files;
mod triangle_mesh;

pub(crate) use icosphere::icosphere;
pub(crate) use mesh_files::MeshFiles;
pub(crate) use triangle_mesh::triangle_mesh;
