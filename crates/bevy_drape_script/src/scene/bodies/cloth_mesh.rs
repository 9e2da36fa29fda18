//! Cloths from any mesh.

use bevy::prelude::*;
use bevy_drape as drape;
use bevy_drape::drape_solver::MeshCloth;
use bevy_drape::prelude::Fabric;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::mesh::MeshFiles;
use crate::scene::bodies::cloth::{friction, rigidity};
use crate::scene::bracketed;
use crate::scene::{
    Fraction, Layers, MeshSource, NonNegative, PaintChannel, Positive, Pressure, Solver, Surface, Tearable,
    Turn, Vector,
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
    pub stretch_stiffness: Fraction,
    /// Stiffness across the edges, 0 to 1: resists folding.
    pub bend_stiffness: Fraction,
    /// Rigidity in bending in N m, of which a mesh takes the mean; (0, 0) by default.
    #[serde(deserialize_with = "bracketed")]
    pub bending_rigidity: (NonNegative, NonNegative),
    /// Friction in bending in N, of which a mesh takes the mean; (0, 0) by default. It acts beside a rigidity alone.
    #[serde(deserialize_with = "bracketed")]
    pub bending_friction: (NonNegative, NonNegative),
    /// Damping along the sticks in 1/s.
    pub damping: NonNegative,
    /// Vertices of the mesh that are fixed, besides those that are painted; none by default.
    pub pins: Vec<u32>,
    /// The channel in which vertices above a half are fixed; red by default.
    pub painted_pins: Option<PaintChannel>,
    /// The channel that limits the distance of vertices from their places, as a fraction of `full_distance`; none, no
    /// limits, by default.
    pub painted_limits: Option<PaintChannel>,
    /// The distance in metres that a value of 1 stands for; 1 by default.
    pub full_distance: Positive,
    /// Target volume of a closed mesh, in units of the rest volume, 0 to 1000: 1.2 inflates a balloon; none by default.
    pub pressure: Option<Pressure>,
    /// Position of its mesh's origin in metres; (0, 0, 0) by default.
    pub at: Vector,
    /// Rotation; none by default.
    pub turn: Turn,
    /// Velocity of its free particles at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// Tearing limits; never tears by default.
    pub tearable: Option<Tearable>,
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

impl Default for ClothMesh {
    fn default() -> Self {
        let plain = drape::render::ClothMesh::default();
        let fabric = Fabric::default();
        Self {
            mesh: MeshSource::default(),
            areal_density: Positive::known(fabric.areal_density),
            stretch_stiffness: Fraction::known(fabric.stretch_stiffness),
            bend_stiffness: Fraction::known(fabric.bend_stiffness),
            bending_rigidity: (NonNegative::known(0.0), NonNegative::known(0.0)),
            bending_friction: (NonNegative::known(0.0), NonNegative::known(0.0)),
            damping: NonNegative::known(fabric.damping),
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
            surface: Surface::default(),
            layers: None,
            contacts: false,
            material: None,
            present: true,
        }
    }
}

impl ClothMesh {
    /// Builds it as the plugin will.
    ///
    /// # Errors
    /// The problem with its mesh, in words.
    pub(crate) fn build(&self, files: &MeshFiles) -> Result<MeshCloth, String> {
        let place = Transform::from_translation(self.at.get()).with_rotation(self.turn.quaternion());
        let mesh = self.mesh.mesh(files)?;
        drape::render::ClothMesh::from(self)
            .build(&Fabric::from(self), &mesh, &place.into())
            .map_err(|fault| fault.to_string())
    }
}

impl From<&ClothMesh> for drape::render::ClothMesh {
    fn from(cloth: &ClothMesh) -> Self {
        Self {
            pins: cloth.pins.clone(),
            paint: drape::render::ClothPaint {
                pins: cloth.painted_pins.map(Into::into),
                max_distance: cloth.painted_limits.map(Into::into),
                full_distance: cloth.full_distance.get(),
                ..Default::default()
            },
            ..Self::default()
        }
    }
}

impl From<&ClothMesh> for Fabric {
    fn from(cloth: &ClothMesh) -> Self {
        Self {
            areal_density: cloth.areal_density.get(),
            stretch_stiffness: cloth.stretch_stiffness.get(),
            bend_stiffness: cloth.bend_stiffness.get(),
            bending_rigidity: rigidity(cloth.bending_rigidity),
            bending_friction: friction(cloth.bending_friction),
            damping: cloth.damping.get(),
            ..Self::default()
        }
    }
}
