//! Points that hang between four particles.

use glam::{DMat3, Vec3};

/// A point at the weighted sum of four particles' positions, such as a corner of the collision mesh of a rigid body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EmbeddedPoint {
    /// Indices of the particles.
    pub particles: [u32; 4],
    /// Weights of the particles, which sum to 1. Outside the tetrahedron of the four, some are negative.
    pub weights: [f32; 4],
}

impl EmbeddedPoint {
    /// Embeds `point` in these `particles` at `places`, by its barycentric coordinates. None if the four lie in a
    /// plane.
    pub fn new(particles: [u32; 4], places: [Vec3; 4], point: Vec3) -> Option<Self> {
        let [origin, a, b, c] = places.map(Vec3::as_dvec3);
        let axes = DMat3::from_cols(a - origin, b - origin, c - origin);
        let longest = axes.x_axis.length().max(axes.y_axis.length()).max(axes.z_axis.length());
        if axes.determinant().abs() <= FLAT * longest * longest * longest {
            return None;
        }
        let along = (axes.inverse() * (point.as_dvec3() - origin)).as_vec3();
        let weights = [1.0 - along.x - along.y - along.z, along.x, along.y, along.z];
        weights.iter().all(|weight| weight.is_finite()).then_some(Self { particles, weights })
    }

    /// The position of the point when its particles are at `places`.
    pub fn position(&self, [a, b, c, d]: [Vec3; 4]) -> Vec3 {
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2] + d * self.weights[3]
    }
}

/// Six times the volume of four points that count as lying in a plane, in parts of the cube of their greatest distance.
const FLAT: f64 = 1e-6;

/// Bounds on the distance of embedded points from the particles, and on their relative speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EmbeddingReach {
    /// Greatest distance at rest from a point to the nearest of its particles, in metres.
    pub overhang: f32,
    /// Greatest sum of the absolute weights of a point; 1 without points.
    pub spread: f32,
}

impl Default for EmbeddingReach {
    fn default() -> Self {
        Self { overhang: 0.0, spread: 1.0 }
    }
}
