//! The whole of a scene file.

use std::path::Path;

use bevy::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Body, Camera, Cannon, Event, Expectation, Material, Named, Obstacle, Parameter, Settings, Whole, WindZone,
};
use crate::SceneError;
use crate::check::check;
use crate::load;
use crate::mesh_file::MeshFiles;
use crate::overriding::{self, Override};
use crate::text;

/// The version of the format that this crate reads.
pub const FORMAT_VERSION: u32 = 1;

/// A scripted scene: what is in it, what happens, and what is expected.
#[derive(Asset, TypePath, Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneScript {
    /// Version of the format: 1.
    pub version: Whole<FORMAT_VERSION, FORMAT_VERSION>,
    /// What the scene shows, in a sentence.
    #[serde(default)]
    pub about: String,
    /// Fragments whose bodies, obstacles and so on are part of this scene: paths from this file's folder. A fragment is
    /// written as a scene, but has no settings.
    #[serde(default)]
    pub include: Vec<String>,
    /// What a run can change by a name of its own.
    #[serde(default)]
    pub parameters: Named<Parameter>,
    /// What holds for the whole scene.
    #[serde(default)]
    pub settings: Settings,
    /// Materials by name.
    #[serde(default)]
    pub materials: Named<Material>,
    /// Bodies by name.
    #[serde(default)]
    pub bodies: Named<Body>,
    /// Obstacles by name.
    #[serde(default)]
    pub obstacles: Named<Obstacle>,
    /// Winds in some places only, by name.
    #[serde(default)]
    pub winds: Named<WindZone>,
    /// Cannons by name.
    #[serde(default)]
    pub cannons: Named<Cannon>,
    /// Cameras by name.
    #[serde(default)]
    pub cameras: Named<Camera>,
    /// What happens, and when.
    #[serde(default)]
    pub timeline: Vec<Event>,
    /// What the scene must do.
    #[serde(default)]
    pub expectations: Vec<Expectation>,
    /// What was read from the files of meshes that it names.
    #[serde(skip)]
    pub(crate) meshes: MeshFiles,
}

impl Default for SceneScript {
    fn default() -> Self {
        Self {
            version: Whole::known(FORMAT_VERSION),
            about: String::new(),
            include: Vec::new(),
            parameters: Named::default(),
            settings: Settings::default(),
            materials: Named::default(),
            bodies: Named::default(),
            obstacles: Named::default(),
            winds: Named::default(),
            cannons: Named::default(),
            cameras: Named::default(),
            timeline: Vec::new(),
            expectations: Vec::new(),
            meshes: MeshFiles::default(),
        }
    }
}

impl SceneScript {
    /// The scene in the file at `path`, with what it includes.
    ///
    /// # Errors
    /// [`SceneError`] telling file, line, column, field, and what was expected there.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_with(path, &[])
    }

    /// The same, with some values replaced.
    ///
    /// # Errors
    /// [`SceneError`], also where an override names what there is not or gives it what it cannot be.
    pub fn load_with(path: impl AsRef<Path>, overrides: &[Override]) -> Result<Self, SceneError> {
        load::from_file(path.as_ref(), overrides)
    }

    /// The scene in `text`, which may not name other files.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        load::from_text(text)
    }

    /// The same scene with some values replaced.
    ///
    /// # Errors
    /// [`SceneError`] where an override names what there is not, gives it what it cannot be, or the scene does not fit
    /// together any more.
    pub fn with(self, overrides: &[Override]) -> Result<Self, SceneError> {
        let script = overriding::apply(self, overrides)?;
        check(&script).map_err(|error| overriding::blame(&script, overrides, error))?;
        Ok(script)
    }

    /// The names of everything in it: bodies, obstacles, winds, cannons, cameras, materials and parameters.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let things = self.bodies.keys().chain(self.obstacles.keys()).chain(self.winds.keys());
        let others = self
            .cannons
            .keys()
            .chain(self.cameras.keys())
            .chain(self.materials.keys())
            .chain(self.parameters.keys());
        things.chain(others).map(String::as_str)
    }

    /// The scene as the text of a file.
    ///
    /// # Errors
    /// [`SceneError`] if it cannot be written as text.
    pub fn to_ron(&self) -> Result<String, SceneError> {
        text::write(self)
    }
}
