//! Cloths from any mesh.

use bevy::prelude::*;
use bevy_drape::drape_solver::MeshCloth;
use bevy_drape::prelude as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::mesh::MeshFiles;
use crate::scene::{
    Fraction, Layers, MeshSource, NonNegative, PaintChannel, Positive, Pressure, Solver, Tearable, Turn,
    Vector,
};

/// A cloth from any mesh: cape, tent, balloon. Vertices in the same place are one particle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ClothMesh {
    /// Its mesh; a sphere of 0.25 m by default.
    pub mesh: MeshSource,
    /// Mass per area in kg/m^2; 0.25 by default.
    pub areal_density: Positive,
    /// Stiffness of the edges, 0 (slack) to 1 (rigid): resists stretching and skewing.
    pub structural_stiffness: Fraction,
    /// Stiffness across the edges, 0 to 1: resists folding.
    pub bend_stiffness: Fraction,
    /// Damping along the sticks in 1/s.
    pub damping: NonNegative,
    /// Vertices of the mesh that are fixed, besides those that are painted; none by default.
    pub pins: Vec<u32>,
    /// The channel in which vertices above a half are fixed; red by default.
    pub painted_pins: Option<PaintChannel>,
    /// The channel that says how far a vertex may get from its place, in parts of `full_distance`; none by default: without limits.
    pub painted_limits: Option<PaintChannel>,
    /// The distance in metres that a value of 1 stands for; 1 by default.
    pub full_distance: Positive,
    /// What volume a closed one keeps, in parts of that at rest, 0 to 1000: 1.2 blows up a balloon; none by default.
    pub pressure: Option<Pressure>,
    /// Where its mesh's origin is, in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// How it is turned; not at all by default.
    pub turn: Turn,
    /// Velocity of its free particles at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// When it tears; never by default.
    pub tearable: Option<Tearable>,
    /// How it is solved; as the scene's settings have it by default.
    pub solver: Solver,
    /// Which layers it is in and which it touches; all by default.
    pub layers: Option<Layers>,
    /// Whether its contacts are told; false by default.
    pub contacts: bool,
    /// Name of its material, for pictures; none by default.
    pub material: Option<String>,
    /// Whether it is there at the start, and not only once it is spawned; true by default.
    pub present: bool,
}

impl Default for ClothMesh {
    fn default() -> Self {
        let plain = drape::ClothMesh::default();
        Self {
            mesh: MeshSource::default(),
            areal_density: Positive::known(plain.areal_density),
            structural_stiffness: Fraction::known(plain.structural_stiffness),
            bend_stiffness: Fraction::known(plain.bend_stiffness),
            damping: NonNegative::known(plain.damping),
            pins: Vec::new(),
            painted_pins: Some(PaintChannel::Red),
            painted_limits: None,
            full_distance: Positive::known(plain.paint.full_distance),
            pressure: None,
            at: Vector::default(),
            turn: Turn::default(),
            velocity: Vector::default(),
            tearable: None,
            solver: Solver::default(),
            layers: None,
            contacts: false,
            material: None,
            present: true,
        }
    }
}

impl ClothMesh {
    /// What the plugin will make of it.
    ///
    /// # Errors
    /// What is wrong with its mesh, in words.
    pub(crate) fn build(&self, files: &MeshFiles) -> Result<MeshCloth, String> {
        let place = Transform::from_translation(self.at.get()).with_rotation(self.turn.quaternion());
        let mesh = self.mesh.mesh(files)?;
        drape::ClothMesh::from(self).build(&mesh, &place.into()).map_err(|fault| fault.to_string())
    }
}

impl From<&ClothMesh> for drape::ClothMesh {
    fn from(cloth: &ClothMesh) -> Self {
        Self {
            areal_density: cloth.areal_density.get(),
            structural_stiffness: cloth.structural_stiffness.get(),
            bend_stiffness: cloth.bend_stiffness.get(),
            damping: cloth.damping.get(),
            pins: cloth.pins.clone(),
            paint: drape::ClothPaint {
                pins: cloth.painted_pins.map(Into::into),
                max_distance: cloth.painted_limits.map(Into::into),
                full_distance: cloth.full_distance.get(),
                ..Default::default()
            },
            ..Self::default()
        }
    }
}
