//! Scenes as files describe them.

use bevy::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Body, Camera, Cannon, Event, Expectation, Material, Named, Obstacle, Parameter, SCHEMA, Settings, Whole,
    WindZone,
};
use crate::mesh::MeshFiles;
use crate::text::{self, SceneError};

/// The version of the format that this crate reads.
pub const FORMAT_VERSION: u32 = 1;

/// A scripted scene: its bodies and obstacles, its timeline, its expectations.
#[derive(Asset, TypePath, Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneScript {
    /// Version of the format: 1.
    pub version: Whole<FORMAT_VERSION, FORMAT_VERSION>,
    /// The purpose of the scene, in a sentence.
    #[serde(default)]
    pub about: String,
    /// Fragments whose bodies, obstacles and so on are part of this scene: paths from this file's folder. A fragment is
    /// written like a scene, but has no settings.
    #[serde(default)]
    pub include: Vec<String>,
    /// Parameters that a run can set, by name.
    #[serde(default)]
    pub parameters: Named<Parameter>,
    /// Settings of the whole scene.
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
    /// Local winds by name.
    #[serde(default)]
    pub winds: Named<WindZone>,
    /// Cannons by name.
    #[serde(default)]
    pub cannons: Named<Cannon>,
    /// Cameras by name.
    #[serde(default)]
    pub cameras: Named<Camera>,
    /// Events.
    #[serde(default)]
    pub timeline: Vec<Event>,
    /// Expectations that the scene has to meet.
    #[serde(default)]
    pub expectations: Vec<Expectation>,
    /// The meshes from the files that it names.
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

    /// Parses the scene in `text` as it stands: without fragments, overrides and checks.
    pub(crate) fn from_ron(text: &str) -> Result<Self, SceneError> {
        text::parse(text, &SCHEMA)
    }

    /// The scene as the text of a file.
    ///
    /// # Errors
    /// [`SceneError`] if it cannot be written as text.
    pub fn to_ron(&self) -> Result<String, SceneError> {
        text::write(self)
    }
}
