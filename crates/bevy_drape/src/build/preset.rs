//! Materials that are known by name.

use bevy::prelude::*;
use drape_solver::ClothMaterial;

use crate::body::settings::SolverSettings;
use crate::build::cloth::Cloth;

/// A material of cloth: `Cloth::new(2.0, 1.5).with_preset(Preset::Silk)` with `SolverSettings::from(Preset::Silk)`.
///
/// What each weighs, and where that is from, stands at the [solver's](drape_solver::Preset); `docs/presets.md` has what
/// was measured. Stiffness is that for some 20 particles to the metre, as [`Cloth::new`] has them.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum Preset {
    /// Flows, and falls slowly.
    Silk,
    /// A shirt.
    #[default]
    Cotton,
    /// Stands in stiff folds.
    Denim,
    /// Hardly folds.
    Leather,
    /// Stretches, and has no tethers.
    Rubber,
    /// Skews as it likes.
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
    /// These with the surface, the air and the tethers of a material; how well it is solved stays.
    #[must_use]
    pub fn with_preset(self, preset: Preset) -> Self {
        drape_solver::Preset::from(preset).settings(self.into()).into()
    }
}

impl Cloth {
    /// Sets what it weighs and how stiff it is. Friction, drag and thickness are in its [`SolverSettings`].
    #[must_use]
    pub fn with_preset(self, preset: Preset) -> Self {
        let ClothMaterial { areal_density, stretch_stiffness, shear_stiffness, bend_stiffness, damping } =
            drape_solver::Preset::from(preset).material();
        Self {
            areal_density,
            structural_stiffness: stretch_stiffness,
            shear_stiffness,
            bend_stiffness,
            damping,
            ..self
        }
    }
}
