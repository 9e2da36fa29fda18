//! The mesh files of a scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::gltf::{FileMesh, read};
use crate::text::unknown;

/// The meshes of all files that a scene names, by the paths as the scene writes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MeshFiles(Arc<BTreeMap<String, Vec<FileMesh>>>);

impl MeshFiles {
    /// The mesh called `name` of the file at `path`, or the only one that it has.
    ///
    /// # Errors
    /// The names that there are instead, in words.
    pub fn mesh(&self, path: &str, name: Option<&str>) -> Result<Mesh, String> {
        let Some(meshes) = self.0.get(path) else {
            return Err(format!(
                "`{path}` has not been read: files are read when a scene is loaded from its own"
            ));
        };
        let names = || meshes.iter().map(|mesh| mesh.name.as_str()).collect::<Vec<_>>();
        match (name, meshes.as_slice()) {
            (None, [only]) => Ok(only.to_bevy()),
            (None, []) => Err(format!("`{path}` has no meshes")),
            (None, _) => Err(format!("expected the `name` of a mesh; `{path}` has: {}", names().join(", "))),
            (Some(name), _) => match meshes.iter().find(|mesh| mesh.name == name) {
                Some(mesh) => Ok(mesh.to_bevy()),
                None => Err(unknown(&format!("no mesh of `{path}` is called `{name}`"), name, &names())),
            },
        }
    }

    /// Adds the meshes in `bytes`, the content of the file at `path`.
    ///
    /// # Errors
    /// The problem with the file, in words.
    pub fn add(&mut self, path: &str, bytes: &[u8]) -> Result<(), String> {
        let meshes =
            read(bytes).map_err(|problem| format!("`{path}` is no glTF file that can be used: {problem}"))?;
        Arc::make_mut(&mut self.0).insert(path.to_string(), meshes);
        Ok(())
    }
}

impl Serialize for MeshFiles {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.as_ref().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for MeshFiles {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        BTreeMap::deserialize(deserializer).map(|meshes| Self(Arc::new(meshes)))
    }
}
