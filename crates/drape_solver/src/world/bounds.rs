//! A box in the world.

use glam::Vec3;

/// An axis-aligned box in the world, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub low: Vec3,
    /// Greatest corner.
    pub high: Vec3,
}

impl Bounds {
    /// The box that meets nothing.
    pub const EMPTY: Self = Self::new(Vec3::INFINITY, Vec3::NEG_INFINITY);

    /// The box between two corners.
    pub const fn new(low: Vec3, high: Vec3) -> Self {
        Self { low, high }
    }

    /// The box around a sphere of `radius` metres.
    pub fn of_sphere(centre: Vec3, radius: f32) -> Self {
        Self::new(centre, centre).grown(radius)
    }

    /// True if the two boxes meet. An empty box, and one that is not a number, meets nothing.
    pub fn overlaps(self, other: Self) -> bool {
        self.low.cmple(other.high).all() && self.high.cmpge(other.low).all()
    }

    /// The box with `by` metres more on every side.
    #[must_use]
    pub fn grown(self, by: f32) -> Self {
        Self::new(self.low - by, self.high + by)
    }

    /// The least box that contains both.
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        Self::new(self.low.min(other.low), self.high.max(other.high))
    }

    /// Distance from `point` to the nearest point of the box, in metres.
    pub fn distance_to(self, point: Vec3) -> f32 {
        point.distance(point.max(self.low).min(self.high))
    }

    /// True if all corners are finite.
    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }
}

impl From<(Vec3, Vec3)> for Bounds {
    fn from((low, high): (Vec3, Vec3)) -> Self {
        Self { low, high }
    }
}
