//! Gravity.

use bevy::prelude::*;
use drape_solver::constants::MAX_MAGNITUDE;

/// Acceleration of gravity in m/s^2.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeGravity(#[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))] pub Vec3);

impl Default for DrapeGravity {
    fn default() -> Self {
        Self(Vec3::new(0.0, -9.81, 0.0))
    }
}

impl DrapeGravity {
    /// True if the solver can compute with it: finite and below 10^6 m/s^2.
    pub(crate) fn is_usable(&self) -> bool {
        // False for NaN.
        self.0.abs().cmple(Vec3::splat(MAX_MAGNITUDE)).all()
    }

    /// This gravity, or the last one that was usable.
    pub(crate) fn or_last(&self, last: Vec3) -> Vec3 {
        if self.is_usable() { self.0 } else { last }
    }
}
