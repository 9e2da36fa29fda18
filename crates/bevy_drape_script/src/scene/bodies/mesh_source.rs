//! Meshes that bodies are made of.

use bevy::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::mesh::{MeshFiles, icosphere, triangle_mesh};
use crate::scene::bracketed;
use crate::scene::{Positive, Vector, Whole};

/// The source of a body's mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum MeshSource {
    /// A mesh of a glTF file in its binary form (`.glb`), in its own coordinates: the transforms of nodes are ignored.
    File {
        /// The file, relative to the folder of the scene that is opened.
        path: String,
        /// Name of the mesh; may be left out if the file has only one.
        #[serde(default)]
        name: Option<String>,
    },
    /// A sphere of nearly equal triangles.
    Sphere {
        /// Radius in metres.
        radius: Positive,
        /// Number of subdivisions of an icosahedron, 0 to 6: 2 gives 162 corners, each more four times as many.
        divisions: Whole<0, 6>,
    },
    /// A box.
    Cuboid {
        /// Its sides in metres.
        #[serde(deserialize_with = "bracketed")]
        size: (Positive, Positive, Positive),
    },
    /// Triangles by hand.
    Triangles {
        /// Corners in metres.
        vertices: Vec<Vector>,
        /// The numbers of their three corners, counted from 0, counter-clockwise as seen from the front.
        triangles: Vec<[u32; 3]>,
    },
}

impl Default for MeshSource {
    fn default() -> Self {
        Self::Sphere { radius: Positive::known(0.25), divisions: Whole::known(2) }
    }
}

impl MeshSource {
    /// The mesh itself, taken from `files` if it is in a file.
    ///
    /// # Errors
    /// The problem, in words.
    pub(crate) fn mesh(&self, files: &MeshFiles) -> Result<Mesh, String> {
        Ok(match self {
            Self::File { path, name } => files.mesh(path, name.as_deref())?,
            Self::Sphere { radius, divisions } => icosphere(radius.get(), divisions.get()),
            Self::Cuboid { size: (x, y, z) } => Cuboid::new(x.get(), y.get(), z.get()).mesh().build(),
            Self::Triangles { vertices, triangles } => {
                let corners: Vec<Vec3> = vertices.iter().map(|corner| corner.get()).collect();
                triangle_mesh(corners, triangles)
            }
        })
    }

    /// The file that it is in, if it is in one.
    pub(crate) fn file(&self) -> Option<&str> {
        match self {
            Self::File { path, .. } => Some(path),
            _ => None,
        }
    }
}
