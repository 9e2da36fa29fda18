//! Untangling of layers that cross, with an edge through a face.
//!
//! The layers do not show on which side of each other they belong. But the line along which they cross must become
//! shorter until it is gone (Volino and Magnenat-Thalmann 2006, "Resolving surface collisions through intersection
//! contour minimization"). The line enters the triangle of the edge at the edge, along the direction `R`, which lies in
//! both planes:
//!
//! ```text
//!        \   |E           the edge (E) is moved against the face (unit normal N) along
//!     ----\--x----> R
//!          \ |              G = R - 2 (E . R) / (E . N) N
//!           \|
//! ```
//!
//! An edge inside a cloth has two triangles, whose moves cancel where the cloth is flat. So the rim of the cloth goes
//! back, and so do the tips of parts that have poked through.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::contact::cloth_contact::Corner;
use crate::contact::effective_mass::effective_inverse_mass;
use crate::state::body::Body;
use crate::state::surface_tree::SurfaceElement;

/// An edge of one triangle through the face of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossedFaces {
    edge: [Corner; 2],
    face: [Corner; 3],
    /// Place of the crossing along the edge, from 0 to 1.
    along: f32,
    /// Weights of the face's corners there.
    weights: [f32; 3],
    /// Direction in which the edge moves against the face, about as long as 1.
    way: Vec3,
}

/// Appends the crossings of two triangles whose corners are at `places`. Either may be a segment.
pub(crate) fn crossings(corners: [[Corner; 3]; 2], places: [[Vec3; 3]; 2], found: &mut Vec<CrossedFaces>) {
    for [own, other] in [[0, 1], [1, 0]] {
        let face = places[other];
        let normal = (face[1] - face[0]).cross(face[2] - face[0]).normalize_or_zero();
        let own_normal = (places[own][1] - places[own][0]).cross(places[own][2] - places[own][0]);
        let heights = places[own].map(|corner| normal.dot(corner - face[0]));
        for k in 0..3 {
            let [p, q] = SurfaceElement::edge(k);
            if heights[p] * heights[q] >= 0.0 {
                continue;
            }
            let along = heights[p] / (heights[p] - heights[q]);
            let edge = places[own][q] - places[own][p];
            let point = places[own][p] + edge * along;
            let Some(weights) = inside(face, normal, point) else { continue };
            let third = places[own][3 - p - q] - places[own][p];
            let line = own_normal.cross(normal).normalize_or_zero();
            // From the edge into its triangle.
            let inward = third - edge * (third.dot(edge) / edge.length_squared());
            let line = if line.dot(inward) < 0.0 { -line } else { line };
            let direction = edge.normalize_or_zero();
            let steep = direction.dot(normal);
            let share = if steep == 0.0 { 0.0 } else { (2.0 * direction.dot(line) / steep).clamp(-2.0, 2.0) };
            found.push(CrossedFaces {
                edge: [corners[own][p], corners[own][q]],
                face: corners[other],
                along,
                weights,
                way: line - normal * share,
            });
        }
    }
}

/// Weights of a point in the plane of a triangle, if it lies inside.
fn inside([a, b, c]: [Vec3; 3], normal: Vec3, point: Vec3) -> Option<[f32; 3]> {
    let area = |p: Vec3, q: Vec3| normal.dot((p - point).cross(q - point));
    let areas = [area(b, c), area(c, a), area(a, b)];
    let sum: f32 = areas.iter().sum();
    (sum > 0.0 && areas.iter().all(|&area| area >= 0.0)).then(|| areas.map(|area| area / sum))
}

impl CrossedFaces {
    /// The particles at the crossing.
    pub fn corners(&self) -> impl Iterator<Item = Corner> {
        self.edge.into_iter().chain(self.face)
    }

    /// Moves the edge by about `way` (metres) against the face, in position only.
    pub fn move_apart(&self, bodies: &mut [Body], way: f32) {
        let [u, v, w] = self.weights;
        let weights = [1.0 - self.along, self.along, -u, -v, -w];
        let corners = [self.edge[0], self.edge[1], self.face[0], self.face[1], self.face[2]];
        let masses = corners.map(|corner| corner.inverse_mass(bodies));
        let total = effective_inverse_mass(weights, masses);
        if total == 0.0 {
            return;
        }
        for ((corner, weight), mass) in corners.into_iter().zip(weights).zip(masses) {
            corner.shift(bodies, self.way * (way * weight * mass / total));
        }
    }
}
