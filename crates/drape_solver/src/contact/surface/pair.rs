//! A corner and a face, or two edges, that may touch.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::geometry::nearest_segments::between_segments;
use crate::geometry::nearest_triangle::on_triangle;

/// The parts that touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The first corner, and the face of the others.
    #[default]
    CornerFace,
    /// The edge of the first two corners, and that of the last two.
    EdgeEdge,
}

/// Two parts that may touch: particles by their numbers among the [points](super::points::Points).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pair {
    pub ids: [u32; 4],
    pub kind: Kind,
    /// The stars that they belong to.
    pub stars: [u32; 2],
    /// The distance that the two keep, in metres; it may be less if they are [near at rest](Self::knows_rest).
    pub distance: f32,
    /// True if the distance takes into account how near they are at rest.
    pub knows_rest: bool,
}

impl Pair {
    /// True if the two share a corner.
    pub fn is_joined(&self) -> bool {
        let [a, b, c, d] = self.ids;
        match self.kind {
            Kind::CornerFace => a == b || a == c || a == d,
            Kind::EdgeEdge => a == c || a == d || b == c || b == d,
        }
    }
}

/// Kinds of pairs, in the order of their lists.
pub(crate) const KINDS: [Kind; 2] = [Kind::CornerFace, Kind::EdgeEdge];

impl Kind {
    /// The number of corners of the first part.
    pub fn first_corners(self) -> usize {
        match self {
            Self::CornerFace => 1,
            Self::EdgeEdge => 2,
        }
    }

    /// Weights of the two nearest points, those of the second part negative.
    pub fn nearest(self, [a, b, c, d]: [Vec3; 4]) -> [f32; 4] {
        match self {
            Self::CornerFace => {
                let [u, v, w] = on_triangle([b, c, d], a);
                [1.0, -u, -v, -w]
            }
            Self::EdgeEdge => {
                let [s, t] = between_segments([a, b], [c, d]);
                [1.0 - s, s, t - 1.0, -t]
            }
        }
    }
}
