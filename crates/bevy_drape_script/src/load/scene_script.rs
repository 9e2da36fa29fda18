//! The ways to a checked scene: from a file, from a text, or from another scene with overrides.

use std::path::Path;

use super::apply::{apply, blame};
use super::check::check;
use super::overrides::Override;
use super::scene_texts::{SceneTexts, mesh_files};
use crate::mesh::MeshFiles;
use crate::scene::SceneScript;
use crate::text::SceneError;

impl SceneScript {
    /// Loads the scene in the file at `path`, with its fragments.
    ///
    /// # Errors
    /// [`SceneError`] with file, line, column, field, and what was expected there.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_with(path, &[])
    }

    /// Loads the scene in the file at `path`, with some values replaced.
    ///
    /// # Errors
    /// [`SceneError`], also for an override whose path does not exist or whose value does not fit there.
    pub fn load_with(path: impl AsRef<Path>, overrides: &[Override]) -> Result<Self, SceneError> {
        let mut texts = SceneTexts::new(path.as_ref());
        while let Some(path) = texts.next_unread() {
            let text = std::fs::read_to_string(&path)
                .map_err(|error| SceneError::new(format!("cannot be read: {error}")).in_file(&path))?;
            texts.add(path, text)?;
        }
        let script = texts.script(overrides)?;
        let mut files = MeshFiles::default();
        for (field, file) in mesh_files(&script) {
            let bytes = std::fs::read(texts.beside_scene(&file)).map_err(|error| error.to_string());
            texts.add_mesh(&mut files, field, &file, bytes)?;
        }
        texts.finish(script, files, overrides)
    }

    /// Parses the scene in `text`, which may not name other files.
    ///
    /// # Errors
    /// [`SceneError`] with line, column, field, and what was expected there.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let script = Self::from_ron(text)?;
        if !script.include.is_empty() {
            return Err(SceneError::of_field("include", "a scene that is no file cannot include others"));
        }
        if let Some((field, _)) = mesh_files(&script).into_iter().next() {
            let error = SceneError::of_field(field, "a scene that is no file cannot name others");
            return Err(error.located_in(text));
        }
        let script = apply(script, &[]).map_err(|error| error.located_in(text))?;
        check(&script).map_err(|error| blame(&script, &[], error).located_in(text))?;
        Ok(script)
    }

    /// Replaces some values of this scene.
    ///
    /// # Errors
    /// [`SceneError`] if the path of an override does not exist, its value does not fit there, or the changed scene
    /// contradicts itself.
    pub fn with(self, overrides: &[Override]) -> Result<Self, SceneError> {
        let script = apply(self, overrides)?;
        check(&script).map_err(|error| blame(&script, overrides, error))?;
        Ok(script)
    }
}
