//! Arrays of equal things.

use bevy::prelude::*;
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
        let mut state = seed;
        let mut random = move || {
            // SplitMix64 (Steele et al. 2014), its upper 24 bits as a number from -1 to 1.
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut bits = state;
            bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((bits ^ (bits >> 31)) >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
        };
        (0..self.total()).map(move |index| {
            let place =
                UVec3::new(index % x.get(), index / x.get() % y.get(), index / (x.get() * y.get())).as_vec3();
            let scatter = Vec3::new(random(), random(), random()) * self.scatter.get();
            (place - middle) * self.spacing.get() + scatter
        })
    }
}
