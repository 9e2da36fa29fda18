//! Rectangular cloths.

use bevy::prelude::*;
use bevy_drape as drape;
use bevy_drape::body::{BendingFriction, MembraneStiffness};
use bevy_drape::prelude::{BendingRigidity, Fabric};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::bracketed;
use crate::scene::{Fraction, Layers, NonNegative, Positive, Solver, Surface, Tearable, Turn, Vector, Whole};

/// A rectangular cloth. Without a `turn` it hangs in the XY plane, centred at `at`, facing +Z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Cloth {
    /// Width and height in metres; (1, 1) by default.
    #[serde(deserialize_with = "bracketed")]
    pub size: (Positive, Positive),
    /// Particles in a row and in a column, 2 to 4096 each; (32, 32) by default.
    #[serde(deserialize_with = "bracketed")]
    pub particles: (Whole<2, 4096>, Whole<2, 4096>),
    /// Mass per area in kg/m^2; 0.25 by default.
    pub areal_density: Positive,
    /// Stiffness of structural sticks, 0 (slack) to 1 (rigid): resists stretching.
    pub stretch_stiffness: Fraction,
    /// Stiffness of shear sticks, 0 to 1: resists skewing.
    pub shear_stiffness: Fraction,
    /// Stiffness of bend sticks, 0 to 1: resists folding.
    pub bend_stiffness: Fraction,
    /// Rigidity in bending in N m, along the warp and along the weft; (0, 0) by default.
    #[serde(deserialize_with = "bracketed")]
    pub bending_rigidity: (NonNegative, NonNegative),
    /// Friction in bending in N, along the warp and along the weft; (0, 0) by default. It acts beside a rigidity alone.
    #[serde(deserialize_with = "bracketed")]
    pub bending_friction: (NonNegative, NonNegative),
    /// Resistance to stretch along the warp, along the weft, and to shear, in N/m; (0, 0, 0) by default. Where a number is not zero, it takes
    /// the place of the stiffness.
    #[serde(deserialize_with = "bracketed")]
    pub membrane_stiffness: (NonNegative, NonNegative, NonNegative),
    /// Damping along the sticks in 1/s.
    pub damping: NonNegative,
    /// Which particles are fixed; the top edge by default.
    pub pins: Pins,
    /// Position of its centre in metres; (0, 0, 0) by default.
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

/// The fixed particles of a cloth. Particles are numbered row by row from the top left.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Pins {
    /// None: the cloth is free.
    None,
    /// The whole top edge: a curtain.
    Top,
    /// The two top corners: a washing line.
    TopCorners,
    /// The whole left edge: a flag.
    Left,
    /// All four corners: a trampoline.
    Corners,
    /// These particles.
    Indices(Vec<u32>),
}

impl Default for Cloth {
    fn default() -> Self {
        let plain = drape::build::Cloth::default();
        let fabric = Fabric::default();
        Self {
            size: (Positive::known(plain.size.x), Positive::known(plain.size.y)),
            particles: (Whole::known(plain.particles.x), Whole::known(plain.particles.y)),
            areal_density: Positive::known(fabric.areal_density),
            stretch_stiffness: Fraction::known(fabric.stretch_stiffness),
            shear_stiffness: Fraction::known(fabric.shear_stiffness),
            bend_stiffness: Fraction::known(fabric.bend_stiffness),
            bending_rigidity: (NonNegative::known(0.0), NonNegative::known(0.0)),
            bending_friction: (NonNegative::known(0.0), NonNegative::known(0.0)),
            membrane_stiffness: [NonNegative::known(0.0); 3].into(),
            damping: NonNegative::known(fabric.damping),
            pins: Pins::Top,
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

impl From<&Cloth> for drape::build::Cloth {
    fn from(cloth: &Cloth) -> Self {
        Self {
            size: Vec2::new(cloth.size.0.get(), cloth.size.1.get()),
            particles: UVec2::new(cloth.particles.0.get(), cloth.particles.1.get()),
            pins: match &cloth.pins {
                Pins::None => drape::build::ClothPins::None,
                Pins::Top => drape::build::ClothPins::Top,
                Pins::TopCorners => drape::build::ClothPins::TopCorners,
                Pins::Left => drape::build::ClothPins::Left,
                Pins::Corners => drape::build::ClothPins::Corners,
                Pins::Indices(indices) => drape::build::ClothPins::Indices(indices.clone()),
            },
        }
    }
}

impl From<&Cloth> for Fabric {
    fn from(cloth: &Cloth) -> Self {
        Self {
            areal_density: cloth.areal_density.get(),
            stretch_stiffness: cloth.stretch_stiffness.get(),
            shear_stiffness: cloth.shear_stiffness.get(),
            bend_stiffness: cloth.bend_stiffness.get(),
            bending_rigidity: rigidity(cloth.bending_rigidity),
            bending_friction: friction(cloth.bending_friction),
            membrane_stiffness: membrane(cloth.membrane_stiffness),
            damping: cloth.damping.get(),
            ..Self::default()
        }
    }
}

fn membrane((warp, weft, shear): (NonNegative, NonNegative, NonNegative)) -> MembraneStiffness {
    MembraneStiffness { warp: warp.get(), weft: weft.get(), shear: shear.get() }
}

/// Rigidity in bending along warp and weft.
pub(super) fn rigidity((warp, weft): (NonNegative, NonNegative)) -> BendingRigidity {
    BendingRigidity { warp: warp.get(), weft: weft.get() }
}

/// Friction in bending along warp and weft.
pub(super) fn friction((warp, weft): (NonNegative, NonNegative)) -> BendingFriction {
    BendingFriction { warp: warp.get(), weft: weft.get() }
}
