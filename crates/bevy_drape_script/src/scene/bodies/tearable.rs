//! Tearing limits.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Positive, Whole};

/// The tearing limits of a body. Pieces have its name and a number: `curtain#1` stays, `curtain#2` is the first that
/// comes off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Tearable {
    /// The strain beyond which a structural stick tears; 0.5, half as long again, by default.
    pub strain: Positive,
    /// Greatest number of particles that are split in one step, 0 to 65536; 16 by default.
    pub most_at_once: Whole<0, 65536>,
    /// Least number of particles of a piece, 0 to 65536; 4 by default. Smaller pieces are despawned.
    pub least_particles: Whole<0, 65536>,
}

impl Default for Tearable {
    fn default() -> Self {
        let drape::body::Tearable { strain, most_at_once, least_particles } =
            drape::body::Tearable::default();
        Self {
            strain: Positive::known(strain),
            most_at_once: Whole::known(most_at_once),
            least_particles: Whole::known(least_particles),
        }
    }
}

impl From<&Tearable> for drape::body::Tearable {
    fn from(tearable: &Tearable) -> Self {
        Self {
            strain: tearable.strain.get(),
            most_at_once: tearable.most_at_once.get(),
            least_particles: tearable.least_particles.get(),
        }
    }
}
