//! The distance to which two parts must come to be listed.
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::constants::BLUNT_EDGES;

/// The greatest distance of two parts that are listed. Asked for one part, with its own thickness, it is that part's share: the
/// shares of two parts add up to at least their reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Factor of the distance that the two keep.
    pub factor: f32,
    /// Metres that corners may be off their ways.
    pub slack: f32,
}

impl Reach {
    /// Reach in metres of a corner and a face that keep this distance: half of it for one of the two.
    #[inline(always)]
    pub fn of_corner<S: Simd>(self, simd: S, distance: f32x16<S>) -> f32x16<S> {
        distance * self.factor + f32x16::splat(simd, self.slack)
    }

    /// The same for edges, whose distance depends on the sharpness of the blunter one.
    #[inline(always)]
    pub fn of_edge<S: Simd>(self, simd: S, distance: f32x16<S>, sharpness: f32x16<S>) -> f32x16<S> {
        self.of_corner(simd, distance_of_edges(distance, sharpness))
    }

    /// The reach of two parts together.
    pub fn of_two(self) -> Self {
        Self { slack: 2.0 * self.slack, ..self }
    }
}

/// Distance that edges keep, where corners and faces keep this `distance`.
#[inline(always)]
pub(crate) fn distance_of_edges<S: Simd>(distance: f32x16<S>, sharpness: f32x16<S>) -> f32x16<S> {
    distance * (sharpness * (1.0 - BLUNT_EDGES) + BLUNT_EDGES)
}
