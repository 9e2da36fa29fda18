//! Materials by name.

use bevy::prelude::*;
use drape_solver::ClothMaterial;

use crate::body::settings::SolverSettings;
use crate::build::cloth::Cloth;

/// A material of cloth: `Cloth::new(2.0, 1.5).with_preset(Preset::Silk)` with `SolverSettings::from(Preset::Silk)`.
///
/// The [solver's](drape_solver::Preset) docs give weights and sources, `docs/presets.md` the measurements. Stiffness is
/// for about 20 particles per metre, as in [`Cloth::new`].
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum Preset {
    /// Soft, and falls slowly.
    Silk,
    /// Cloth of a shirt.
    #[default]
    Cotton,
    /// Stands in stiff folds.
    Denim,
    /// Hardly folds.
    Leather,
    /// Stretches, and has no tethers.
    Rubber,
    /// Skews freely.
    Net,
    /// Mail of steel rings: heavy and limp.
    Chain,
}

impl From<Preset> for drape_solver::Preset {
    fn from(preset: Preset) -> Self {
        match preset {
            Preset::Silk => Self::Silk,
            Preset::Cotton => Self::Cotton,
            Preset::Denim => Self::Denim,
            Preset::Leather => Self::Leather,
            Preset::Rubber => Self::Rubber,
            Preset::Net => Self::Net,
            Preset::Chain => Self::Chain,
        }
    }
}

impl From<Preset> for SolverSettings {
    fn from(preset: Preset) -> Self {
        Self::default().with_preset(preset)
    }
}

impl SolverSettings {
    /// Sets the surface, drag and tethers of a material. The quality of the solution stays.
    #[must_use]
    pub fn with_preset(self, preset: Preset) -> Self {
        drape_solver::Preset::from(preset).settings(self.into()).into()
    }
}

impl Cloth {
    /// Sets density and stiffness. Friction, drag and thickness are in the [`SolverSettings`].
    #[must_use]
    pub fn with_preset(self, preset: Preset) -> Self {
        let ClothMaterial { areal_density, structural, shear, bend, damping } =
            drape_solver::Preset::from(preset).material();
        Self {
            areal_density,
            structural_stiffness: structural,
            shear_stiffness: shear,
            bend_stiffness: bend,
            damping,
            ..self
        }
    }
}
