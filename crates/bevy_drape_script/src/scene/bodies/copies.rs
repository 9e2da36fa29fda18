//! Arrays of equal things.

use bevy::prelude::*;
use bevy_drape::drape_solver::splitmix::SplitMix64;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::bracketed;
use crate::scene::{NonNegative, Vector, Whole};

/// Number and spacing of equal things, in a block around their position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Copies {
    /// Number along X, Y and Z, 1 to 100 each; (1, 1, 1) by default.
    #[serde(deserialize_with = "bracketed")]
    pub count: (Whole<1, 100>, Whole<1, 100>, Whole<1, 100>),
    /// Spacing along each axis in metres; (0.5, 0.5, 0.5) by default.
    pub spacing: Vector,
    /// Greatest random displacement along each axis in metres, drawn by the scene's seed; 0 by default.
    pub scatter: NonNegative,
}

impl Default for Copies {
    fn default() -> Self {
        Self {
            count: (Whole::known(1), Whole::known(1), Whole::known(1)),
            spacing: Vector::known(Vec3::splat(0.5)),
            scatter: NonNegative::known(0.0),
        }
    }
}

impl Copies {
    /// Number in all.
    pub fn total(&self) -> u32 {
        let (x, y, z) = self.count;
        x.get() * y.get() * z.get()
    }

    /// Their positions relative to the centre of the block in metres: along X first, then Y, then Z.
    pub fn offsets(&self, seed: u64) -> impl Iterator<Item = Vec3> + '_ {
        let (x, y, z) = self.count;
        let middle = (UVec3::new(x.get(), y.get(), z.get()).as_vec3() - 1.0) * 0.5;
        let mut random = SplitMix64(seed);
        (0..self.total()).map(move |index| {
            let place =
                UVec3::new(index % x.get(), index / x.get() % y.get(), index / (x.get() * y.get())).as_vec3();
            let scatter = Vec3::new(random.signed(), random.signed(), random.signed()) * self.scatter.get();
            (place - middle) * self.spacing.get() + scatter
        })
    }
}
