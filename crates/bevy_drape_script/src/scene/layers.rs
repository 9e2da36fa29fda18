//! Collision layers.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Whole;

/// The collision layers that something is in, and those that it touches. Two things touch if each is in a layer that
/// the other touches.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Layers {
    /// Numbers of the layers that it is in, 0 to 31.
    pub memberships: Vec<Whole<0, 31>>,
    /// Numbers of the layers that it touches, 0 to 31.
    pub filters: Vec<Whole<0, 31>>,
}

impl From<&Layers> for drape::body::DrapeLayers {
    fn from(layers: &Layers) -> Self {
        let bits =
            |numbers: &[Whole<0, 31>]| numbers.iter().fold(0, |bits, number| bits | 1_u32 << number.get());
        Self { memberships: bits(&layers.memberships), filters: bits(&layers.filters) }
    }
}
