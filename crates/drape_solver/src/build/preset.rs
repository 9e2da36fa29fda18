//! Materials that are known by name: their mass, stiffness, friction and drag.
//!
//! Masses are those of the trade. Silk is sold by the momme, 4.34 g/m^2, and denim by the ounce per square yard, 33.9 g/m^2
//! (Wikipedia, "Units of textile measurement"). If only a thickness is known, mass is density times thickness.
//! Stiffness, friction and drag are chosen to look right. `drape_bench presets` measures the result: the drape coefficient
//! of each material and its stretch under its own weight.
//!
//! Design: `docs/design/presets.md`.

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;

use crate::build::cloth::ClothMaterial;
use crate::state::bending_friction::BendingFriction;
use crate::state::bends::BendingRigidity;
use crate::state::membrane::MembraneStiffness;
use crate::state::settings::BodySettings;

/// A material of cloth. Its stiffness is tuned for about 20 particles per metre: in finer cloth each stick carries more
/// particles, and stretches more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
pub enum Preset {
    /// Crepe de chine of 16 momme: 0.07 kg/m^2. Flows, and falls slowly.
    Silk,
    /// Shirting: 0.12 kg/m^2.
    #[default]
    Cotton,
    /// Denim of 14 ounces per square yard: 0.475 kg/m^2. Stands in stiff folds.
    Denim,
    /// Cowhide of 1.2 mm at 860 kg/m^3: 1.03 kg/m^2. Hardly folds.
    Leather,
    /// A sheet of natural rubber of 1 mm at 930 kg/m^3: 0.93 kg/m^2. Stretches, and has no tethers.
    Rubber,
    /// Twine of 5 g/m in meshes of 10 cm: 0.1 kg/m^2. Skews without resistance, and lets the air through.
    Net,
    /// Mail of 8 mm rings of 1.6 mm steel wire, half a gram each, 18,000 to the square metre: 8.5 kg/m^2.
    Chain,
}

impl Preset {
    /// All presets.
    pub const ALL: [Self; 7] =
        [Self::Silk, Self::Cotton, Self::Denim, Self::Leather, Self::Rubber, Self::Net, Self::Chain];

    /// The name of the preset, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Silk => "silk",
            Self::Cotton => "cotton",
            Self::Denim => "denim",
            Self::Leather => "leather",
            Self::Rubber => "rubber",
            Self::Net => "net",
            Self::Chain => "chain",
        }
    }

    /// Areal density, stiffness and damping.
    pub const fn material(self) -> ClothMaterial {
        let (areal_density, stretch_stiffness, shear_stiffness, bend_stiffness, damping) = match self {
            Self::Silk => (0.07, 1.0, 0.3, 0.02, 0.1),
            Self::Cotton => (0.12, 1.0, 0.6, 0.3, 0.3),
            Self::Denim => (0.475, 1.0, 0.9, 0.85, 0.5),
            Self::Leather => (1.03, 1.0, 0.97, 0.97, 1.0),
            Self::Rubber => (0.93, 0.9, 0.8, 0.5, 1.5),
            Self::Net => (0.1, 1.0, 0.0, 0.0, 0.3),
            Self::Chain => (8.5, 1.0, 0.02, 0.0, 0.5),
        };
        let bending_rigidity = BendingRigidity::isotropic(0.0);
        let membrane_stiffness = MembraneStiffness::balanced(0.0, 0.0);
        ClothMaterial {
            areal_density,
            stretch_stiffness,
            shear_stiffness,
            bend_stiffness,
            bending_rigidity,
            bending_friction: BendingFriction::isotropic(0.0),
            membrane_stiffness,
            damping,
        }
    }

    /// Returns `settings` with the preset's friction, drag, thickness and tethers. Substeps, iterations and the like stay.
    pub fn settings(self, settings: BodySettings) -> BodySettings {
        let (friction, drag, thickness) = self.surface();
        let tethers = settings.tethers && !self.is_extensible();
        BodySettings { friction, drag, thickness, tethers, ..settings }
    }

    /// Coefficient of friction; drag of still air in 1/s; half the thickness in metres.
    pub const fn surface(self) -> (f32, f32, f32) {
        match self {
            Self::Silk => (0.2, 2.0, 0.003),
            Self::Cotton => (0.5, 1.2, 0.004),
            Self::Denim => (0.6, 0.6, 0.005),
            Self::Leather => (0.6, 0.4, 0.006),
            Self::Rubber => (0.9, 0.4, 0.006),
            Self::Net => (0.4, 0.4, 0.004),
            Self::Chain => (0.3, 0.1, 0.008),
        }
    }

    /// True if it is meant to stretch far: tethers would keep it from that.
    pub const fn is_extensible(self) -> bool {
        matches!(self, Self::Rubber)
    }
}

impl From<Preset> for BodySettings {
    fn from(preset: Preset) -> Self {
        Self::default().with_preset(preset)
    }
}

impl BodySettings {
    /// Returns these settings with the friction, drag, thickness and tethers of a preset. Substeps, iterations and the like stay.
    #[must_use]
    pub fn with_preset(self, preset: Preset) -> Self {
        preset.settings(self)
    }
}
