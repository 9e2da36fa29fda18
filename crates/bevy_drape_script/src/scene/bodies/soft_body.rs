//! Soft solids.

use bevy::prelude::*;
use bevy_drape as drape;
use bevy_drape::drape_solver::SoftSolid;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::mesh::MeshFiles;
use crate::scene::{
    Fraction, Layers, MeshSource, NonNegative, PaintChannel, Positive, Pressure, Solver, Surface, Turn,
    Vector,
};

/// A soft solid of any closed mesh: jelly, rubber, fruit. Its particles are the corners of the cells that fill the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SoftBody {
    /// Its mesh, which must be closed; a sphere of 0.25 m by default.
    pub mesh: MeshSource,
    /// The greatest width of a cell in metres; a sixth of the mesh's longest side by default.
    pub spacing: Option<Positive>,
    /// Mass per volume in kg/m^3; 100 by default.
    pub density: Positive,
    /// Stiffness of all sticks, 0 (slack) to 1 (rigid); 0.95 by default.
    pub stiffness: Fraction,
    /// Damping along the sticks in 1/s; 3 by default.
    pub damping: NonNegative,
    /// Vertices of the mesh that are fixed, with the cells that they are in; none by default.
    pub pins: Vec<u32>,
    /// The channel in which vertices above a half are fixed; none by default.
    pub painted_pins: Option<PaintChannel>,
    /// Target volume, in units of the rest volume, 0 to 1000; 1 by default.
    pub pressure: Pressure,
    /// Position of its mesh's origin in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Rotation; none by default.
    pub turn: Turn,
    /// Velocity of its free particles at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// Solver settings; those of the scene by default.
    pub solver: Solver,
    /// Its surface; that of the scene by default.
    pub surface: Surface,
    /// Its collision layers and those that it touches; all by default.
    pub layers: Option<Layers>,
    /// True to report its contacts; false by default.
    pub contacts: bool,
    /// Name of its material, for pictures; none by default.
    pub material: Option<String>,
    /// True to exist from the start, false to wait for `Spawn`; true by default.
    pub present: bool,
}

impl Default for SoftBody {
    fn default() -> Self {
        let plain = drape::render::SoftBodyMesh::default();
        Self {
            mesh: MeshSource::default(),
            spacing: None,
            density: Positive::known(plain.density),
            stiffness: Fraction::known(plain.stiffness),
            damping: NonNegative::known(plain.damping),
            pins: Vec::new(),
            painted_pins: None,
            pressure: Pressure::known(1.0),
            at: Vector::default(),
            turn: Turn::default(),
            velocity: Vector::default(),
            solver: Solver::default(),
            surface: Surface::default(),
            layers: None,
            contacts: false,
            material: None,
            present: true,
        }
    }
}

impl SoftBody {
    /// Builds it as the plugin will.
    ///
    /// # Errors
    /// The problem with its mesh, in words.
    pub(crate) fn build(&self, files: &MeshFiles) -> Result<SoftSolid, String> {
        let place = Transform::from_translation(self.at.get()).with_rotation(self.turn.quaternion());
        let mesh = self.mesh.mesh(files)?;
        drape::render::SoftBodyMesh::from(self).build(&mesh, &place.into()).map_err(|fault| fault.to_string())
    }
}

impl From<&SoftBody> for drape::render::SoftBodyMesh {
    fn from(body: &SoftBody) -> Self {
        Self {
            spacing: body.spacing.map(Positive::get),
            density: body.density.get(),
            stiffness: body.stiffness.get(),
            damping: body.damping.get(),
            pins: body.pins.clone(),
            painted_pins: body.painted_pins.map(Into::into),
        }
    }
}
