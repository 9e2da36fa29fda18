//! Materials that are known by name: `Cloth::new(2.0, 1.5).with_preset(Preset::Silk)` with
//! `SolverSettings::from(Preset::Silk)`. `docs/presets.md` has what was measured.

use drape_solver::ClothMaterial;
pub use drape_solver::Preset;

use crate::build::cloth::Cloth;

impl Cloth {
    /// Sets what it weighs and how stiff it is. Friction, drag and thickness are in its [`SolverSettings`](crate::body::settings::SolverSettings).
    #[must_use]
    pub fn with_preset(self, preset: Preset) -> Self {
        let ClothMaterial { areal_density, stretch_stiffness, shear_stiffness, bend_stiffness, damping } =
            preset.material();
        Self { areal_density, stretch_stiffness, shear_stiffness, bend_stiffness, damping, ..self }
    }
}
