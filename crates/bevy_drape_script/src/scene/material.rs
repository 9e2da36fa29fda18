//! Materials: what things look like.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Fraction;
use super::bracketed;

/// What something looks like. The simulation does not look at it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Material {
    /// Red, green and blue as sRGB, 0 to 1 each; (0.8, 0.8, 0.8), light grey, by default.
    #[serde(deserialize_with = "bracketed")]
    pub colour: (Fraction, Fraction, Fraction),
    /// How rough the surface is, 0 (a mirror) to 1 (chalk, the default).
    pub roughness: Fraction,
    /// How metallic it is, 0 (the default) to 1.
    pub metallic: Fraction,
}

impl Default for Material {
    fn default() -> Self {
        let grey = Fraction::known(0.8);
        Self { colour: (grey, grey, grey), roughness: Fraction::known(1.0), metallic: Fraction::known(0.0) }
    }
}
