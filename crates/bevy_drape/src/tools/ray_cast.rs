//! Ray casts against the faces of simulated bodies, or against the links of bodies without faces.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::body::Sticks;
//! use bevy_drape::ray_cast::cast_ray;
//!
//! fn look(bodies: Query<(Entity, &Particles, &Sticks)>) {
//!     let ray = Ray3d::new(Vec3::new(0.0, 1.0, 5.0), Dir3::NEG_Z);
//!     for (body, particles, sticks) in &bodies {
//!         if let Some(hit) = cast_ray(ray, 10.0, particles, sticks, 0.03) {
//!             println!("{body} is seen {} m away", hit.distance);
//!         }
//!     }
//! }
//! # App::new().add_systems(Update, look).update();
//! ```

use bevy::prelude::*;
use drape_solver::{Particles, Topology};

/// Hit of a ray on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHit {
    /// Distance along the ray in metres.
    pub distance: f32,
    /// The point in the world.
    pub position: Vec3,
    /// Unit normal towards the ray's origin.
    pub normal: Vec3,
    /// Index of the nearest particle of the hit face or link.
    pub particle: usize,
}

/// Returns the first hit of `ray` on a body within `reach` metres: on a face from either side, or on a link, of
/// `radius` metres, of a body without faces. None if it misses, or starts inside a link.
pub fn cast_ray(
    ray: Ray3d,
    reach: f32,
    particles: &Particles,
    topology: &Topology,
    radius: f32,
) -> Option<BodyHit> {
    if particles.len() != topology.particle_count() {
        return None;
    }
    let place = |index: u32| particles.position(index as usize);
    let mut best: Option<(f32, Vec3, [u32; 3])> = None;
    let mut note = |hit: Option<(f32, Vec3)>, corners: [u32; 3]| {
        if let Some((distance, normal)) = hit
            && distance < best.map_or(reach, |best| best.0)
        {
            best = Some((distance, normal, corners));
        }
    };
    if topology.faces().is_empty() {
        for &[a, b] in topology.segments() {
            note(meet_link(ray, [a, b].map(place), radius), [a, b, b]);
        }
    } else {
        for &face in topology.faces() {
            note(meet_face(ray, face.map(place)), face);
        }
    }
    let (distance, normal, corners) = best?;
    let position = ray.get_point(distance);
    let away = |index: u32| place(index).distance_squared(position);
    let nearest = corners.into_iter().min_by(|&a, &b| away(a).total_cmp(&away(b)))?;
    Some(BodyHit { distance, position, normal, particle: nearest as usize })
}

/// Returns distance and normal of the hit of a ray on a triangle (Möller and Trumbore 1997).
fn meet_face(ray: Ray3d, [a, b, c]: [Vec3; 3]) -> Option<(f32, Vec3)> {
    let direction = *ray.direction;
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    let offset = ray.origin - a;
    let part_b = offset.dot(across) / determinant;
    let turned = offset.cross(ab);
    let part_c = direction.dot(turned) / determinant;
    let distance = ac.dot(turned) / determinant;
    // Comparisons with NaN, as for a face seen edge on, are false, so it is no hit.
    if part_b >= 0.0 && part_c >= 0.0 && part_b + part_c <= 1.0 && distance >= 0.0 {
        let normal = ab.cross(ac).normalize_or_zero();
        Some((distance, if normal.dot(direction) > 0.0 { -normal } else { normal }))
    } else {
        None
    }
}

/// Returns distance and normal of the hit of a ray on a link of `radius`: a sphere around the link's point nearest to
/// the ray.
fn meet_link(ray: Ray3d, [a, b]: [Vec3; 2], radius: f32) -> Option<(f32, Vec3)> {
    let (direction, along) = (*ray.direction, b - a);
    let offset = ray.origin - a;
    let aside = along.reject_from_normalized(direction);
    let length_squared = aside.length_squared();
    let part = if length_squared > 0.0 { (offset.dot(aside) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    meet_sphere(ray, a + along * part, radius)
}

/// Returns distance and normal of the hit on a sphere of a ray that starts outside.
pub(crate) fn meet_sphere(ray: Ray3d, centre: Vec3, radius: f32) -> Option<(f32, Vec3)> {
    let offset = centre - ray.origin;
    let along = offset.dot(*ray.direction);
    let left = radius * radius - offset.reject_from_normalized(*ray.direction).length_squared();
    let distance = along - left.sqrt();
    if left >= 0.0 && distance >= 0.0 {
        Some((distance, (ray.get_point(distance) - centre).normalize_or_zero()))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use drape_solver::{ClothBuilder, RopeBuilder};

    use super::*;

    #[test]
    fn a_ray_meets_the_nearest_fold_from_either_side() {
        let (mut particles, topology) = ClothBuilder::new(1.0, 1.0, 5, 5).build_parts().expect("valid");
        for i in 0..particles.len() {
            let place = particles.position(i);
            // A slope of 45 degrees.
            particles.set_position(i, place + Vec3::Z * place.y);
        }
        for side in [1.0, -1.0] {
            let ray = Ray3d::new(
                Vec3::new(0.3, -0.4, 5.0 * side),
                Dir3::new(Vec3::NEG_Z * side).expect("a length"),
            );
            let hit = cast_ray(ray, 100.0, &particles, &topology, 0.0).expect("a hit");
            let slope = hit.position.z - hit.position.y;
            assert!(
                (hit.distance - (5.0 - side * hit.position.z)).abs() < 1e-5 && slope.abs() < 1e-5,
                "{hit:?}"
            );
            let normal = Vec3::new(0.0, -1.0, 1.0).normalize() * side;
            assert!(hit.normal.distance(normal) < 1e-5, "{hit:?}");
            let nearest = (0..particles.len())
                .min_by(|&a, &b| {
                    let away = |i| particles.position(i).distance(hit.position);
                    away(a).total_cmp(&away(b))
                })
                .expect("some");
            assert_eq!(hit.particle, nearest);
            assert_eq!(cast_ray(ray, 1.0, &particles, &topology, 0.0), None, "out of reach");
        }
        let beside = Ray3d::new(Vec3::new(1.2, -0.4, 5.0), Dir3::NEG_Z);
        assert_eq!(cast_ray(beside, 100.0, &particles, &topology, 0.0), None);
        let away = Ray3d::new(Vec3::new(0.3, -0.4, 5.0), Dir3::Z);
        assert_eq!(cast_ray(away, 100.0, &particles, &topology, 0.0), None, "behind the eye");
    }

    #[test]
    fn a_rope_is_as_thick_as_its_radius() {
        let (particles, topology) = RopeBuilder::new(Vec3::ZERO, Vec3::X, 5).build_parts().expect("valid");
        let ray = |y| Ray3d::new(Vec3::new(0.4, y, 2.0), Dir3::NEG_Z);
        let hit = cast_ray(ray(0.03), 10.0, &particles, &topology, 0.05).expect("a hit");
        assert!((hit.distance - (2.0 - 0.04)).abs() < 1e-5, "{hit:?}");
        assert!(hit.normal.distance(Vec3::new(0.0, 0.6, 0.8)) < 1e-4, "{hit:?}");
        assert!(hit.particle == 2, "{hit:?}");
        assert_eq!(cast_ray(ray(0.06), 10.0, &particles, &topology, 0.05), None);
    }
}
