//! Materials for pictures.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Fraction;
use super::bracketed;

/// The look of a surface. It does not affect the simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Material {
    /// Red, green and blue as sRGB, 0 to 1 each; (0.8, 0.8, 0.8), light grey, by default.
    #[serde(deserialize_with = "bracketed")]
    pub colour: (Fraction, Fraction, Fraction),
    /// Roughness, 0 (a mirror) to 1 (chalk, the default).
    pub roughness: Fraction,
    /// Metalness, 0 (the default) to 1.
    pub metallic: Fraction,
}

impl Default for Material {
    fn default() -> Self {
        let grey = Fraction::known(0.8);
        Self { colour: (grey, grey, grey), roughness: Fraction::known(1.0), metallic: Fraction::known(0.0) }
    }
}
