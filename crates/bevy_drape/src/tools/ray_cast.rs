//! Ray casts against the faces of a body, or against the links of a body without faces.
//! [`DrapeSpatialQuery`](crate::spatial_query::DrapeSpatialQuery) casts against all bodies at once.
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
use drape_solver::world::bounds::Bounds;
use drape_solver::{Particles, Topology};

pub use crate::tools::body_hit::BodyHit;
use crate::tools::body_hit::{SurfaceHit, first_hit};

/// Returns the first hit of `ray` on a body within `reach` metres: on a face from either side, or on a link, of
/// `radius` metres, of a body without faces. None if it misses, or starts inside a link, or if any of it is NaN.
pub fn cast_ray(
    ray: Ray3d,
    reach: f32,
    particles: &Particles,
    topology: &Topology,
    radius: f32,
) -> Option<BodyHit> {
    let on_face = |face| meet_face(ray, face);
    let on_link = |link| meet_link(ray, link, radius);
    first_hit(particles, topology, reach, on_face, on_link)
}

/// Returns the hit of a ray on a triangle (Möller and Trumbore 1997).
pub(crate) fn meet_face(ray: Ray3d, [a, b, c]: [Vec3; 3]) -> Option<SurfaceHit> {
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
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        Some(SurfaceHit { distance, position: ray.get_point(distance), normal })
    } else {
        None
    }
}

/// Returns the hit of a ray that starts outside on a link of `radius`, with a half-sphere at each end. A link without length
/// is a sphere.
pub(crate) fn meet_link(ray: Ray3d, [a, b]: [Vec3; 2], radius: f32) -> Option<SurfaceHit> {
    let (direction, axis) = (*ray.direction, b - a);
    // As seen along the ray, which is a point then.
    let offset = (ray.origin - a).reject_from_normalized(direction);
    let aside = axis.reject_from_normalized(direction);
    let room = |part: f32| radius * radius - (offset - aside * part).length_squared();
    let (width, climb) = (aside.length(), axis.dot(direction));
    let nearest = if width > 0.0 { offset.dot(aside) / (width * width) } else { 0.0 };
    // A comparison with NaN is false, so it is no hit.
    let is_met = room(nearest.clamp(0.0, 1.0)) >= 0.0;
    if !is_met {
        return None;
    }
    // The link is the spheres around all points of its axis. The ray enters first that of a point towards its origin from
    // the nearest: where moving on gains as much along the ray as it loses aside.
    let part = if width > 0.0 {
        nearest - room(nearest).max(0.0).sqrt() * climb / (width * axis.length())
    } else {
        -climb.signum()
    };
    let part = part.clamp(0.0, 1.0);
    let centre = a + axis * part;
    let distance = (centre - ray.origin).dot(direction) - room(part).max(0.0).sqrt();
    let position = ray.get_point(distance);
    let normal = (position - centre).normalize_or_zero();
    (distance >= 0.0).then_some(SurfaceHit { distance, position, normal })
}

/// True if a ray may meet a box within `reach` metres.
pub(crate) fn meets_box(ray: Ray3d, reach: f32, Bounds { low, high }: Bounds) -> bool {
    let inverse = ray.direction.recip();
    let (a, b) = ((low - ray.origin) * inverse, (high - ray.origin) * inverse);
    // NaN, as for a ray in the plane of a side, leaves the decision to the other axes.
    let is_open = a.is_nan_mask() | b.is_nan_mask();
    let enter = Vec3::select(is_open, Vec3::NEG_INFINITY, a.min(b)).max_element();
    let leave = Vec3::select(is_open, Vec3::INFINITY, a.max(b)).min_element();
    enter <= leave && leave >= 0.0 && enter <= reach
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

    /// Against spheres along the axis, as finely as single precision can tell.
    #[test]
    fn a_link_is_met_where_its_capsule_begins_from_any_direction() {
        let (link, radius) = ([Vec3::new(0.1, 0.2, -0.1), Vec3::new(0.5, -0.1, 0.3)], 0.05);
        // From -1 to 1.
        let wave = |k: f32| 2.0 * k.fract() - 1.0;
        let spin = |k: f32| Vec3::new(wave(k * 0.71), wave(k * 1.37), wave(k * 2.93));
        let mut hits = 0;
        for turn in 1..2000 {
            let at = link[0].lerp(link[1], spin(turn as f32 * 0.31).x) + 0.06 * spin(turn as f32 * 0.17);
            let Ok(direction) = Dir3::new(spin(turn as f32)) else { continue };
            let ray = Ray3d::new(at - *direction * 3.0, direction);
            let spheres = (0..=2000).filter_map(|i| {
                let offset = link[0].lerp(link[1], i as f32 / 2000.0) - ray.origin;
                let left = radius * radius - offset.reject_from_normalized(*direction).length_squared();
                (left >= 0.0).then(|| offset.dot(*direction) - left.sqrt())
            });
            let first = spheres.min_by(f32::total_cmp);
            let hit = meet_link(ray, link, radius);
            if let (Some(hit), Some(first)) = (hit, first) {
                hits += 1;
                assert!((hit.distance - first).abs() < 1e-3, "{hit:?}, not {first}");
                let inwards = hit.position - hit.normal * radius;
                let part = (inwards - link[0]).dot(link[1] - link[0]) / link[0].distance_squared(link[1]);
                assert!(link[0].lerp(link[1], part.clamp(0.0, 1.0)).distance(inwards) < 1e-3, "{hit:?}");
            }
            // Rays that graze it may differ.
            let grazing = meet_link(ray, link, radius * 1.01).is_some()
                && meet_link(ray, link, radius * 0.99).is_none();
            assert!(hit.is_some() == first.is_some() || grazing, "{hit:?} and {first:?}");
        }
        assert!(hits > 500, "{hits}");
    }
}
