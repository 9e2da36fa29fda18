//! The meeting of a query and a body.

use bevy::prelude::*;
use drape_solver::{Particles, Topology};

/// The place at which a ray or a sphere meets a body, or that is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHit {
    /// Distance in metres: along the ray, of the sphere's way, or from the point.
    pub distance: f32,
    /// The point of the body in the world.
    pub position: Vec3,
    /// Unit normal of the body there, towards the ray's origin, the sphere's centre or the point. Zero if that lies on
    /// the surface and so on neither side.
    pub normal: Vec3,
    /// Index of the nearest particle of the hit face or link.
    pub particle: usize,
}

/// The same, of a face or link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceHit {
    pub distance: f32,
    pub position: Vec3,
    pub normal: Vec3,
}

/// Returns the hit on a body of least distance, within `max_distance` metres: on its faces, or on its links if it has no
/// faces. None if `max_distance` is negative or NaN.
pub(crate) fn first_hit(
    particles: &Particles,
    topology: &Topology,
    max_distance: f32,
    on_face: impl Fn([Vec3; 3]) -> Option<SurfaceHit>,
    on_link: impl Fn([Vec3; 2]) -> Option<SurfaceHit>,
) -> Option<BodyHit> {
    if particles.len() != topology.particle_count() {
        return None;
    }
    let place = |index: u32| particles.position(index as usize);
    let mut first: Option<(SurfaceHit, [u32; 3])> = None;
    let mut note = |hit: Option<SurfaceHit>, corners: [u32; 3]| {
        // A distance that is NaN is within nothing.
        if let Some(hit) = hit
            && hit.distance <= max_distance
            && first.is_none_or(|(first, _)| hit.distance < first.distance)
        {
            first = Some((hit, corners));
        }
    };
    if topology.faces().is_empty() {
        for &[a, b] in topology.segments() {
            note(on_link([a, b].map(place)), [a, b, b]);
        }
    } else {
        for (face, weights) in topology.triangles() {
            let [a, b, c] = face.map(place);
            let corner = |Vec3 { x, y, z }: Vec3| a * x + b * y + c * z;
            note(on_face(weights.map(corner)), face);
        }
    }
    let (SurfaceHit { distance, position, normal }, corners) = first?;
    let away = |index: u32| place(index).distance_squared(position);
    let nearest = corners.into_iter().min_by(|&a, &b| away(a).total_cmp(&away(b)))?;
    Some(BodyHit { distance, position, normal, particle: nearest as usize })
}
