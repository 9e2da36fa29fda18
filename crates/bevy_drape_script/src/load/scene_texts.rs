//! The texts of a scene and its fragments, however they were read.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::apply::{apply, blame};
use super::check::check;
use super::fragments::with_fragments;
use super::overrides::Override;
use super::paths::{beside, normal};
use crate::mesh::MeshFiles;
use crate::scene::{MeshSource, SceneScript};
use crate::text::{SceneError, locate};

/// The texts of a scene and of all fragments that it includes. The caller reads the files, one after another.
pub(crate) struct SceneTexts {
    /// The path of the scene itself.
    scene: PathBuf,
    texts: BTreeMap<PathBuf, String>,
    unread: Vec<PathBuf>,
}

impl SceneTexts {
    /// Begins with the scene at `path`, which is the first unread file.
    pub fn new(path: &Path) -> Self {
        let scene = normal(path);
        Self { unread: vec![scene.clone()], scene, texts: BTreeMap::new() }
    }

    /// The path of a file that has to be read and [added](Self::add).
    pub fn next_unread(&mut self) -> Option<PathBuf> {
        while let Some(path) = self.unread.pop() {
            if !self.texts.contains_key(&path) {
                return Some(path);
            }
        }
        None
    }

    /// Adds the text of the file at `path`. The fragments that it includes become unread files.
    pub fn add(&mut self, path: PathBuf, text: String) -> Result<(), SceneError> {
        let script = SceneScript::from_ron(&text).map_err(|error| error.in_file(&path))?;
        self.unread.extend(script.include.iter().map(|fragment| beside(&path, fragment)));
        self.texts.insert(path, text);
        Ok(())
    }

    /// The scene with its fragments and `overrides`, once all files have been read. It lacks its meshes.
    pub fn script(&self, overrides: &[Override]) -> Result<SceneScript, SceneError> {
        let script = with_fragments(&self.scene, &self.texts, &mut Vec::new())?;
        apply(script, overrides).map_err(|error| self.located(error))
    }

    /// The path of a file that the scene names.
    pub fn beside_scene(&self, file: &str) -> PathBuf {
        beside(&self.scene, file)
    }

    /// Adds the content of a mesh file, or the reason why it could not be read. `field` names the file.
    pub fn add_mesh(
        &self,
        files: &mut MeshFiles,
        field: String,
        file: &str,
        bytes: Result<Vec<u8>, String>,
    ) -> Result<(), SceneError> {
        let bytes = bytes.map_err(|error| format!("`{file}` cannot be read: {error}"));
        bytes
            .and_then(|bytes| files.add(file, &bytes))
            .map_err(|problem| self.located(SceneError::of_field(field, problem)))
    }

    /// Gives the scene its meshes and checks it as a whole.
    pub fn finish(
        &self,
        script: SceneScript,
        meshes: MeshFiles,
        overrides: &[Override],
    ) -> Result<SceneScript, SceneError> {
        let script = SceneScript { meshes, ..script };
        check(&script).map_err(|error| self.located(blame(&script, overrides, error)))?;
        Ok(script)
    }

    /// The same error with file, line and column of its field, be it in the scene or in a fragment.
    fn located(&self, error: SceneError) -> SceneError {
        if error.origin.is_some() {
            return error.in_file(&self.scene);
        }
        // The text in which most of the path is found; the scene itself, if it is as good as any.
        let own = self.texts.get_key_value(&self.scene).into_iter();
        let places = own.chain(self.texts.iter()).filter_map(|(file, text)| {
            let (place, depth) = locate(text, &error.field)?;
            Some((depth, place, file))
        });
        let best = places.reduce(|best, next| if next.0 > best.0 { next } else { best });
        match best {
            Some((_, place, file)) => error.at(place).in_file(file),
            None => error.in_file(&self.scene),
        }
    }
}

/// The mesh files that a scene names, each once, with the field that names it.
pub(crate) fn mesh_files(script: &SceneScript) -> Vec<(String, String)> {
    let mut files: Vec<(String, String)> = Vec::new();
    for (name, body) in script.bodies.iter() {
        if let Some(file) = body.mesh().and_then(MeshSource::file)
            && files.iter().all(|(_, known)| known != file)
        {
            files.push((format!("bodies.{name}.mesh.path"), file.to_string()));
        }
    }
    files
}
