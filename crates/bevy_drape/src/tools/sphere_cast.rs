//! Sphere casts against a body.

use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;
use drape_solver::{Particles, Topology};

use crate::tools::body_hit::{BodyHit, SurfaceHit, first_hit};
use crate::tools::ray_cast::{meet_face, meet_link, meets_box};

/// Returns where a sphere of `radius` metres, whose centre moves along `path`, first touches a body within `max_distance`
/// metres. It must not touch the body where it starts. Links have a radius of `thickness` metres. None for a radius that is
/// negative or NaN.
pub(crate) fn cast_sphere(
    path: Ray3d,
    radius: f32,
    max_distance: f32,
    particles: &Particles,
    topology: &Topology,
    thickness: f32,
) -> Option<BodyHit> {
    if radius.is_nan() || radius < 0.0 {
        return None;
    }
    // From the centre of the sphere back to its surface.
    let touch = |hit: SurfaceHit| SurfaceHit { position: hit.position - hit.normal * radius, ..hit };
    let on_face = |face| meet_thick_face(path, radius, max_distance, face).map(touch);
    let on_link = |link| meet_link(path, link, radius + thickness).map(touch);
    first_hit(particles, topology, max_distance, on_face, on_link)
}

/// Returns the hit of a ray that starts outside on all that lies within `radius` of a triangle: on the triangle moved to
/// both sides, or on a link around an edge.
fn meet_thick_face(ray: Ray3d, radius: f32, max_distance: f32, face: [Vec3; 3]) -> Option<SurfaceHit> {
    let [a, b, c] = face;
    let bounds = Bounds::new(a.min(b).min(c), a.max(b).max(c)).grown(radius);
    if !meets_box(ray, max_distance, bounds) {
        return None;
    }
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let side = if normal.dot(ray.origin - a) < 0.0 { -normal } else { normal };
    let flat = meet_face(ray, face.map(|corner| corner + side * radius));
    let edges = [[a, b], [b, c], [c, a]].map(|edge| meet_link(ray, edge, radius));
    let hits = edges.into_iter().chain([flat]).flatten();
    hits.min_by(|one, other| one.distance.total_cmp(&other.distance))
}
