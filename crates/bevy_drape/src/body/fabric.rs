//! Fabrics.
//!
//! Design: `docs/design/presets.md`.

use bevy::prelude::*;
use drape_solver::{
    BendingFriction, BendingRigidity, BodySettings, BuildError, ClothMaterial, MeasuredFabric,
    MembraneStiffness, Preset,
};

use crate::body::surface::BodySurface;

/// The fabric of a cloth, in numbers. `docs/presets.md` has the measured behaviour of those that are known by name.
///
/// A change of density, stiffness or damping builds the cloth anew; a change of the other numbers acts on the cloth as it is.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands) {
/// commands.spawn((Cloth::new(2.0, 1.5), Fabric::SILK));
/// commands.spawn((Cloth::new(2.0, 1.5), Fabric { friction: 0.9, ..Fabric::DENIM }));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fabric {
    /// Mass per area in kg/m^2, above 0.
    pub areal_density: f32,
    /// Stiffness of structural sticks, 0 (slack) to 1 (rigid): resists stretching. Edges of a
    /// `ClothMesh` are such sticks, and resist skewing too.
    pub stretch_stiffness: f32,
    /// Stiffness of the shear sticks of a [`Cloth`](crate::build::Cloth), 0 to 1: resists skewing. A `ClothMesh` has none.
    pub shear_stiffness: f32,
    /// Stiffness of bend sticks, 0 to 1: resists folding.
    pub bend_stiffness: f32,
    /// Rigidity in bending as a textile laboratory measures it, in N m along warp and weft; none by default. A `ClothMesh` takes the
    /// mean of both. Bend sticks act besides: give them a `bend_stiffness` of 0.
    pub bending_rigidity: BendingRigidity,
    /// Friction in bending as a textile laboratory measures it, in N along warp and weft; none by default. It acts beside a
    /// `bending_rigidity` alone: gives the cloth body, and lets a fold keep a curvature.
    pub bending_friction: BendingFriction,
    /// Resistance to stretch and shear as a textile laboratory measures it, in N/m; none by default. Where a number of it is not zero, a
    /// [`Cloth`](crate::build::Cloth) takes it in place of the stiffness from 0 to 1. With warp or weft no tether holds it. A `ClothMesh` ignores it.
    pub membrane_stiffness: MembraneStiffness,
    /// Damping along the sticks in 1/s, 0 or more.
    pub damping: f32,
    /// True if it is meant to stretch far, as rubber is: then no tether holds it.
    pub extensible: bool,
    /// Coefficient of Coulomb friction, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, for surfaces that do not slide yet. A value below `friction` counts as `friction`.
    pub static_friction: f32,
    /// Distance in metres that the middle of the cloth keeps from the surfaces that it touches: half its thickness.
    pub thickness: f32,
    /// Drag of still air in 1/s, 0 or more: velocity decays as `exp(-drag t)`, whatever the step.
    pub drag: f32,
}

impl Default for Fabric {
    /// A cotton of 0.25 kg/m^2 that does not stretch, and folds easily.
    fn default() -> Self {
        Self::new(ClothMaterial::default(), BodySettings::default().into(), false)
    }
}

impl From<Preset> for Fabric {
    fn from(preset: Preset) -> Self {
        Self::of(preset)
    }
}

impl From<MeasuredFabric> for Fabric {
    fn from(measured: MeasuredFabric) -> Self {
        Self::measured(measured)
    }
}

impl Fabric {
    /// [`Preset::Silk`].
    pub const SILK: Self = Self::of(Preset::Silk);
    /// [`Preset::Cotton`].
    pub const COTTON: Self = Self::of(Preset::Cotton);
    /// [`Preset::Denim`].
    pub const DENIM: Self = Self::of(Preset::Denim);
    /// [`Preset::Leather`].
    pub const LEATHER: Self = Self::of(Preset::Leather);
    /// [`Preset::Rubber`].
    pub const RUBBER: Self = Self::of(Preset::Rubber);
    /// [`Preset::Net`].
    pub const NET: Self = Self::of(Preset::Net);
    /// [`Preset::Chain`].
    pub const CHAIN: Self = Self::of(Preset::Chain);

    /// A fabric with the mass, the stretch, the shear and the bending that a laboratory has measured, and with the surface of the default.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_drape::prelude::*;
    /// use bevy_drape::build::MeasuredFabric;
    ///
    /// # fn setup(mut commands: Commands) {
    /// commands.spawn((Cloth::new(1.0, 1.0), Fabric::measured(MeasuredFabric::WoolTropical)));
    /// # }
    /// ```
    pub fn measured(measured: MeasuredFabric) -> Self {
        Self::new(measured.material(), BodySettings::default().into(), false)
    }

    const fn of(preset: Preset) -> Self {
        let (friction, drag, thickness) = preset.surface();
        let surface = BodySurface { friction, static_friction: 0.0, thickness, drag };
        Self::new(preset.material(), surface, preset.is_extensible())
    }

    const fn new(material: ClothMaterial, surface: BodySurface, extensible: bool) -> Self {
        Self {
            areal_density: material.areal_density,
            stretch_stiffness: material.stretch_stiffness,
            shear_stiffness: material.shear_stiffness,
            bend_stiffness: material.bend_stiffness,
            bending_rigidity: material.bending_rigidity,
            bending_friction: material.bending_friction,
            membrane_stiffness: material.membrane_stiffness,
            damping: material.damping,
            extensible,
            friction: surface.friction,
            static_friction: surface.static_friction,
            thickness: surface.thickness,
            drag: surface.drag,
        }
    }

    /// Its surface.
    pub fn surface(&self) -> BodySurface {
        let Self { friction, static_friction, thickness, drag, .. } = *self;
        BodySurface { friction, static_friction, thickness, drag }
    }

    /// The same fabric with this surface.
    #[must_use]
    pub fn with_surface(self, surface: BodySurface) -> Self {
        let BodySurface { friction, static_friction, thickness, drag } = surface;
        Self { friction, static_friction, thickness, drag, ..self }
    }

    /// The component that has the number at fault: the fabric, if there is one and it is a number of its sticks, or the
    /// description of this name.
    pub(crate) fn or_description(
        fabric: Option<&Self>,
        error: Option<&BuildError>,
        description: &'static str,
    ) -> &'static str {
        match (fabric, error.and_then(BuildError::field)) {
            (
                Some(_),
                Some(
                    "areal_density" | "damping" | "stiffness" | "stretch stiffness" | "bend stiffness"
                    | "bending_rigidity" | "bending_friction" | "membrane_stiffness",
                ),
            ) => "Fabric",
            _ => description,
        }
    }

    /// The mass and the sticks that the solver gives a cloth of it.
    pub fn material(&self) -> ClothMaterial {
        ClothMaterial {
            areal_density: self.areal_density,
            stretch_stiffness: self.stretch_stiffness,
            shear_stiffness: self.shear_stiffness,
            bend_stiffness: self.bend_stiffness,
            bending_rigidity: self.bending_rigidity,
            bending_friction: self.bending_friction,
            membrane_stiffness: self.membrane_stiffness,
            damping: self.damping,
        }
    }
}
