//! The nearest point of a body.

use bevy::prelude::*;
use drape_solver::geometry::nearest_triangle::{on_segment, on_triangle};
use drape_solver::{Particles, Topology};

use crate::tools::body_hit::{BodyHit, SurfaceHit, first_hit};

/// Returns the point of a body that is nearest to `point`, within `max_distance` metres: of its faces, or of its links, of
/// `radius` metres, if it has no faces. A point inside a link is its own nearest.
pub(crate) fn project_point(
    point: Vec3,
    max_distance: f32,
    particles: &Particles,
    topology: &Topology,
    radius: f32,
) -> Option<BodyHit> {
    let on_face = |face| Some(nearest_of_face(point, face));
    let on_link = |link| Some(nearest_of_link(point, link, radius));
    first_hit(particles, topology, max_distance, on_face, on_link)
}

/// Returns the point of a triangle that is nearest to `point`.
fn nearest_of_face(point: Vec3, face: [Vec3; 3]) -> SurfaceHit {
    let [a, b, c] = on_triangle(face, point);
    let position = face[0] * a + face[1] * b + face[2] * c;
    let offset = point - position;
    SurfaceHit { distance: offset.length(), position, normal: offset.normalize_or_zero() }
}

/// Returns the point of a link of `radius` that is nearest to `point`.
fn nearest_of_link(point: Vec3, link: [Vec3; 2], radius: f32) -> SurfaceHit {
    let [a, b, _] = on_segment(link, point);
    let axis = link[0] * a + link[1] * b;
    let offset = point - axis;
    let (distance, normal) = (offset.length() - radius, offset.normalize_or_zero());
    if distance < 0.0 {
        SurfaceHit { distance: 0.0, position: point, normal }
    } else {
        SurfaceHit { distance, position: axis + normal * radius, normal }
    }
}
